//! Requests of any kind: the core refuses or answers, all numbers finite but where it says that it failed.
#![no_main]

use libfuzzer_sys::{Corpus, fuzz_target};
use permway_core::{
    sensitivity::Sensitivity,
    sweep::{Control, Formulation, Request, lengths, sweep_with},
};
use permway_fuzz::Draw;

fuzz_target!(|bytes: &[u8]| -> Corpus {
    let mut draw = Draw::absurd(bytes);
    let (Ok(drawn), Ok(dense), Ok(derive), Ok(all)) = (draw.request(), draw.flag(), draw.flag(), draw.flag())
    else {
        return Corpus::Reject;
    };
    let request = Request {
        line: &drawn.line,
        frequencies: &drawn.frequencies,
        laws: &drawn.laws,
        n_laws: drawn.n_laws,
        forces: &drawn.forces,
        sensors: &drawn.sensors,
        formulation: if dense { Formulation::Receptance } else { Formulation::Chain },
        joints: all,
        threads: 1,
    };
    let joints = drawn.line.joints.len();
    let groups: Vec<Option<usize>> = drawn.line.joints.iter().map(|j| Some(j.law)).collect();
    let weights = vec![1.0; joints];
    let every: Vec<usize> = (0..drawn.forces.len()).collect();
    let derived = Sensitivity {
        groups: &groups,
        weights: &weights,
        n_groups: drawn.n_laws,
        bodies: all,
        sensors: &every,
        forces: &every,
        own: all,
    };
    let derived = derive.then_some(&derived);
    let Ok(answer) = sweep_with(&request, derived, &Control::default()) else { return Corpus::Keep };
    let failed: Vec<usize> = answer.failures.iter().map(|(i, _)| *i).collect();
    let all = [&answer.sensors, &answer.joints, &answer.derivatives, &answer.own];
    for (values, length) in all.into_iter().zip(lengths(&request, derived)) {
        for (i, row) in values.chunks(length.max(1)).enumerate().filter(|(i, _)| !failed.contains(i)) {
            assert!(row.iter().all(|v| v.is_finite()), "not finite at {} Hz, unsaid", drawn.frequencies[i]);
        }
    }
    Corpus::Keep
});
