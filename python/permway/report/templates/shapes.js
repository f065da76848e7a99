// Each shape moves as the real part of its complex displacement, times exp(i phase); two seconds a period.
const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
for (const figure of document.querySelectorAll("figure.shape")) {
  const s = JSON.parse(figure.querySelector("script").textContent);
  const bodies = figure.querySelectorAll(".body"), joints = figure.querySelector(".joint");
  const button = figure.querySelector("button"), slider = figure.querySelector(".phase"), size = figure.querySelector(".size");
  const [shown, larger] = figure.querySelectorAll("output");
  let far = s.far;
  const down = (i, c, d) => i < 0 ? s.ground : s.y[i] + far * (s.re[i] * c - s.im[i] * d);
  const show = (degrees) => {
    const c = Math.cos(degrees * Math.PI / 180), d = Math.sin(degrees * Math.PI / 180);
    s.bodies.forEach((body, n) => {
      const points = body.map((i) => `${s.x[i]},${down(i, c, d).toFixed(1)}`);
      bodies[n].setAttribute("d", "M" + (points.length > 1 ? points : [points[0], points[0]]).join("L"));
    });
    joints.setAttribute("d", s.joints.map(([a, b]) => {
      const x = s.x[a < 0 ? b : a];
      return `M${x},${down(a, c, d).toFixed(1)}L${s.x[b < 0 ? a : b]},${down(b, c, d).toFixed(1)}`;
    }).join(""));
    slider.value = degrees; shown.textContent = `${Math.round(degrees)}°`;
  };
  let moving = !still, last = 0, phase = s.phase;
  const label = () => { button.textContent = moving ? "Stop" : "Play"; };
  const step = (time) => {
    if (!moving) return;
    if (last) phase = (phase + (time - last) * 0.18) % 360;
    last = time; show(phase); requestAnimationFrame(step);
  };
  const play = (on) => { moving = on; last = 0; label(); if (on) requestAnimationFrame(step); };
  button.addEventListener("click", () => play(!moving));
  slider.addEventListener("input", () => { phase = Number(slider.value); play(false); show(phase); });
  size.addEventListener("input", () => {
    const times = 10 ** (size.value / 20);
    far = s.far * times; larger.textContent = `× ${times.toPrecision(2)}`;
    if (!moving) show(phase);
  });
  show(phase); play(moving);
}
