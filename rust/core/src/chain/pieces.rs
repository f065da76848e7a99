//! The distinct lengths of beam of a line, and what memory their transfers share.

use super::tape::Op;
use std::collections::BTreeMap;

/// Lengths closer than this are one piece, m: with equal spacing they differ by rounding of the coordinates alone,
/// which is below 1e-12 m for places up to 2 km from the origin, and then few are distinct. Half of it would tell
/// more of them apart beyond 1 km, twice of it fewer; the answer changes by rounding.
const SAME_LENGTH: f64 = 1e-12;

/// A length of a beam or shaft whose transfer is computed once per frequency.
#[derive(Debug, Clone, Copy)]
pub struct Piece {
    /// Index of the body.
    pub body: usize,
    /// The stretch of the body whose section it has; `None` for the body's own.
    pub stretch: Option<usize>,
    /// Length in m.
    pub length: f64,
    /// Terms of the series that it needs at the highest frequency.
    pub terms: usize,
    /// Where its transfer is kept from its first use to its last.
    pub slot: usize,
}

/// The distinct pieces met so far, found by length.
#[derive(Debug, Default)]
pub struct Pieces {
    list: Vec<Piece>,
    known: BTreeMap<(usize, Option<usize>, i64), usize>,
    #[cfg(test)]
    compared: usize,
}

impl Pieces {
    /// Index of the piece of that length, which is a new one unless it is known. A length is compared with those of at
    /// most three cells of the width of [`SAME_LENGTH`], however many are known.
    pub fn find(
        &mut self,
        body: usize,
        stretch: Option<usize>,
        length: f64,
        terms: impl FnOnce() -> usize,
    ) -> usize {
        #[allow(clippy::cast_possible_truncation)]
        // Of a length beyond 9,000 km, which no piece has, the last cell.
        let cell = (length / SAME_LENGTH).floor() as i64;
        let [below, above] = [cell.saturating_sub(1), cell.saturating_add(1)];
        let near = self.known.range((body, stretch, below)..=(body, stretch, above));
        #[cfg(test)]
        let near = near.inspect(|_| self.compared += 1);
        let same = near.map(|(_, i)| *i).filter(|i| (self.list[*i].length - length).abs() < SAME_LENGTH);
        same.min().unwrap_or_else(|| {
            let new = self.list.len();
            self.list.push(Piece { body, stretch, length, terms: terms(), slot: 0 });
            self.known.entry((body, stretch, cell)).or_insert(new);
            new
        })
    }

    /// The pieces with their slots, how many slots there are, and every march told whether it is its piece's first or
    /// last. A slot is free again after the last march: of lengths that are all different each needs the same one.
    pub fn placed(self, ops: &mut [Op]) -> (Vec<Piece>, usize) {
        let mut pieces = self.list;
        let mut left = vec![0_usize; pieces.len()];
        for op in ops.iter() {
            if let Op::March { piece, .. } = op {
                left[*piece] += 1;
            }
        }
        let mut met = vec![false; pieces.len()];
        let (mut free, mut slots) = (Vec::new(), 0);
        for op in ops {
            let Op::March { piece, first, last, .. } = op else { continue };
            *first = !std::mem::replace(&mut met[*piece], true);
            if *first {
                pieces[*piece].slot = free.pop().unwrap_or_else(|| {
                    slots += 1;
                    slots - 1
                });
            }
            left[*piece] -= 1;
            *last = left[*piece] == 0;
            if *last {
                free.push(pieces[*piece].slot);
            }
        }
        (pieces, slots)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Spacings that are all different are looked up in a number of comparisons that does not grow with them.
    #[test]
    fn a_new_length_is_compared_with_few() {
        for n in [1000_usize, 8000] {
            let mut pieces = Pieces::default();
            for i in 0..n {
                assert_eq!(pieces.find(0, None, 0.6 + 1e-6 * (i * 7919 % n) as f64, || 1), i);
            }
            assert!(pieces.compared <= 3 * n, "{} comparisons of {n} lengths", pieces.compared);
        }
    }

    #[test]
    fn lengths_that_differ_by_rounding_are_one() {
        let mut pieces = Pieces::default();
        for k in 0..2000 {
            let x = 0.6 * f64::from(k);
            pieces.find(0, None, 0.6 * f64::from(k + 1) - x, || 1);
        }
        assert_eq!(pieces.list.len(), 1);
        // Either side of the border between two cells.
        let edge = 0.7;
        let found = [-0.4, 0.4, 0.0].map(|off| pieces.find(0, None, edge + off * SAME_LENGTH, || 1));
        assert_eq!(found, [1; 3]);
        assert_eq!(pieces.find(0, None, edge + 2.0 * SAME_LENGTH, || 1), 2);
        assert_eq!(pieces.find(0, Some(0), edge, || 1), 3);
        assert_eq!(pieces.find(1, None, edge, || 1), 4);
    }

    #[test]
    fn absurd_lengths_are_pieces_too() {
        let mut pieces = Pieces::default();
        for (i, length) in [1e7, 1e15, 1e300, f64::INFINITY, f64::NAN, -1e300].into_iter().enumerate() {
            assert_eq!(pieces.find(0, None, length, || 1), i);
        }
        assert_eq!(pieces.find(0, None, 1e7, || 1), 0);
    }
}
