// What lies under the pointer, in the picture's own numbers; a click enlarges the picture and another one shrinks it.
for (const shot of document.querySelectorAll("figure.shot")) {
  const image = shot.querySelector("img"), frame = shot.querySelector(".scroll");
  const source = shot.querySelector("script[type='application/json']");
  const panels = source ? JSON.parse(source.textContent) : [];
  const box = document.createElement("output");
  box.className = "readout"; box.hidden = true; shot.append(box);
  const between = (value, low, high) => value >= Math.min(low, high) && value <= Math.max(low, high);
  const to = (scale, share) => {
    const [low, high] = scale.limits;
    return scale.log ? low * (high / low) ** share : low + (high - low) * share;
  };
  const away = (scale, one, other) => {
    const [low, high] = scale.limits;
    return scale.log ? Math.log(one / other) / Math.log(high / low) : (one - other) / (high - low);
  };
  const words = (value) => {
    const size = Math.abs(value);
    return size !== 0 && (size >= 1e5 || size < 1e-3) ? value.toExponential(3) : Number(value.toPrecision(4)).toString();
  };
  const named = (scale, value) => {
    const near = scale.names.reduce((best, one) =>
      best === null || Math.abs(one[0] - value) < Math.abs(best[0] - value) ? one : best, null);
    return near ? near[1] : `${scale.label}: ${words(value)}`;
  };
  const cell = (edges, value) => edges.findIndex((edge, i) => i + 1 < edges.length && between(value, edge, edges[i + 1]));
  const read = (panel, x, y, wide, high) => {
    const rows = [];
    for (const map of panel.maps) {
      const column = cell(map.x, x), row = cell(map.y, y);
      if (column < 0 || row < 0) continue;
      const value = map.values[row][column];
      rows.push(`${named(panel.y, 0.5 * (map.y[row] + map.y[row + 1]))}`,
        `${panel.x.label}: ${words(x)}`, `${map.label || "value"}: ${value === null ? "none" : words(value)}`);
      return rows;
    }
    const shown = new Set();
    for (const line of panel.lines) {
      if (shown.has(line.label)) continue;
      let best = -1, least = Infinity;
      line.x.forEach((at, i) => {
        const across = away(panel.x, at, x) * wide, up = line.alone ? away(panel.y, line.y[i], y) * high : 0;
        const distance = Math.hypot(across, up);
        if (distance < least) { least = distance; best = i; }
      });
      if (best < 0 || least > (line.alone ? 14 : 10)) continue;
      if (!rows.length) {
        if (line.alone && panel.y.names.length) rows.push(named(panel.y, line.y[best]));
        else rows.push(`${panel.x.label}: ${words(line.x[best])}`);
      }
      shown.add(line.label);
      rows.push(`${line.label}: ${words(line.alone && panel.y.names.length ? line.x[best] : line.y[best])}`);
    }
    return rows;
  };
  const move = (event) => {
    const area = image.getBoundingClientRect();
    const across = (event.clientX - area.left) / area.width, down = (event.clientY - area.top) / area.height;
    const panel = panels.find((p) => between(across, p.box[0], p.box[2]) && between(down, p.box[1], p.box[3]));
    const rows = [];
    if (panel) {
      const [left, top, right, bottom] = panel.box;
      const x = to(panel.x, (across - left) / (right - left)), y = to(panel.y, (bottom - down) / (bottom - top));
      rows.push(...read(panel, x, y, (right - left) * area.width, (bottom - top) * area.height));
    }
    box.hidden = rows.length === 0;
    box.replaceChildren(...rows.map((text) => Object.assign(document.createElement("div"), { textContent: text })));
    const place = shot.getBoundingClientRect(), gap = 14;
    const left = event.clientX - place.left + gap;
    box.style.left = `${Math.max(0, left + box.offsetWidth > place.width ? left - box.offsetWidth - 2 * gap : left)}px`;
    box.style.top = `${event.clientY - place.top + gap}px`;
  };
  image.addEventListener("pointermove", move);
  image.addEventListener("pointerdown", move);
  image.addEventListener("pointerleave", () => { box.hidden = true; });
  image.addEventListener("click", (event) => {
    const before = image.getBoundingClientRect();
    const across = (event.clientX - before.left) / before.width;
    shot.classList.toggle("large");
    frame.scrollLeft = across * image.getBoundingClientRect().width - frame.clientWidth / 2;
  });
}

// Where a table is wider than the phone it is a list of its rows, each cell with its column's name; but for those with
// many columns or spans. In closed details nothing has a width: there the columns count.
for (const table of document.querySelectorAll(".scroll > table")) {
  const heads = table.tHead ? [...table.tHead.rows] : [], names = heads.length === 1 ? [...heads[0].cells] : [];
  const spans = [...table.querySelectorAll("th, td")].some((cell) => cell.colSpan > 1 || cell.rowSpan > 1);
  if (spans || names.length < 2 || names.length > 12) continue;
  const wide = table.offsetWidth;
  if (wide ? wide <= table.parentElement.clientWidth + 1 : names.length < 4) continue;
  table.classList.add("stack");
  for (const row of [...table.tBodies].flatMap((body) => [...body.rows]))
    [...row.cells].forEach((cell, i) => {
      if (cell.tagName === "TD" && i > 0 && cell.textContent.trim()) cell.dataset.label = names[i].textContent.trim();
    });
}
