// The curves of the step table: a chart for each column that changes, one for all energies together.
"use strict";
const report = (() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const number = v => {
    if (v === null || v === undefined || Number.isNaN(v)) return "–";
    if (v === 0) return "0";
    const size = Math.abs(v);
    if (size >= 1e5 || size < 1e-3) return v.toExponential(3).replace(/\.?0+e/, "e").replace("e+", "e");
    return String(Number(v.toPrecision(5)));
  };
  return { data, css, dark, number, marks: [], onlive: [] };
})();

(() => {
  const place = document.getElementById("charts");
  if (!place) return;
  const { css, dark, number } = report;
  const select = document.getElementById("axis");
  const colours = ["--c0", "--c1", "--c2", "--c3", "--c4", "--c5"];
  let charts = [];

  const rises = list => list.length > 1 && list.every((v, k) => v !== null && (k === 0 || v >= list[k - 1]));
  const axes = () => {
    const { steps, times } = report.data.curves;
    const known = { time: times, step: steps, row: steps.map((_, k) => k) };
    return Object.entries(known).filter(([name, list]) => name === "row" || rises(list));
  };

  // What lies on the same axis: energies are of one unit.
  const groups = () => {
    const { columns } = report.data.curves;
    const still = c => {
      const known = c.values.filter(v => v !== null);
      return known.every(v => v === known[0]);
    };
    const shown = columns.filter(c => !["step", "time"].includes(c.name));
    const moving = shown.filter(c => !still(c));
    const energies = moving.filter(c => report.data.energies.includes(c.name)).slice(0, colours.length);
    const list = moving.map(c => ({ title: c.name, columns: [c] }));
    if (energies.length > 1) list.unshift({ title: "energies", columns: energies });
    return { list, same: shown.filter(still) };
  };

  const titled = name => {
    const [first] = (report.data.film || { frames: [] }).frames;
    return name === "time" && first && first.units[1] ? `time [${first.units[1]}]` : name;
  };
  const ticks = (_, values) => values.map(v => (v === null ? "" : number(v)));
  const chart = (figure, group, name, x) => {
    const ink = css("--ink"), line = css("--line");
    const axis = { stroke: ink, grid: { stroke: line, width: 1 }, ticks: { stroke: line, width: 1 }, values: ticks, font: "12px system-ui" };
    const series = group.columns.map((c, k) => ({
      label: c.name, stroke: css(colours[k]), width: 1.6, value: (_, v) => number(v), spanGaps: true,
      points: { show: x.length < 3 },
    }));
    const now = u => report.marks.forEach(mark => {
      const at = mark[name];
      if (at === undefined || at < u.scales.x.min || at > u.scales.x.max) return;
      const px = Math.round(u.valToPos(at, "x", true));
      u.ctx.save();
      u.ctx.strokeStyle = css("--accent");
      u.ctx.setLineDash([4, 4]);
      u.ctx.beginPath();
      u.ctx.moveTo(px, u.bbox.top);
      u.ctx.lineTo(px, u.bbox.top + u.bbox.height);
      u.ctx.stroke();
      u.ctx.restore();
    });
    const options = {
      width: figure.clientWidth - 20, height: 210,
      series: [{ label: titled(name), value: (_, v) => number(v) }, ...series],
      axes: [{ ...axis, space: 60 }, { ...axis, size: 66 }],
      scales: { x: { time: false } },
      cursor: { sync: { key: "rows" }, drag: { x: true, y: false } },
      legend: { show: true },
      hooks: { draw: [now] },
    };
    const u = new uPlot(options, [x, ...group.columns.map(c => c.values)], figure);
    u.root.querySelectorAll("th").forEach(th => th.setAttribute("scope", "row"));
    return u;
  };

  const draw = () => {
    charts.forEach(c => c.u.destroy());
    place.replaceChildren();
    const [name, x] = axes().find(([name]) => name === select.value) || axes()[0];
    const { list, same } = groups();
    charts = list.map(group => {
      const figure = document.createElement("figure");
      const caption = document.createElement("figcaption");
      caption.textContent = group.title;
      figure.setAttribute("aria-label", `${group.title} over ${name}; the numbers stand in the table of figures`);
      figure.setAttribute("role", "group");
      figure.append(caption);
      place.append(figure);
      return { figure, u: chart(figure, group, name, x) };
    });
    if (same.length) {
      const text = document.createElement("p");
      text.className = "same";
      text.textContent = "Always the same: " + same.map(c => `${c.name} = ${number(c.values.find(v => v !== null))}`).join(", ");
      place.append(text);
    }
  };

  const offer = () => {
    const known = axes().map(([name]) => name), was = select.value;
    select.replaceChildren(...known.map(name => new Option(name)));
    select.value = known.includes(was) ? was : known[0];
  };
  offer();
  draw();
  select.addEventListener("change", draw);
  dark.addEventListener("change", draw);
  new ResizeObserver(() => charts.forEach(({ figure, u }) => {
    const width = figure.clientWidth - 20;
    if (width > 0 && width !== u.width) u.setSize({ width, height: 210 });
  })).observe(place);
  report.mark = mark => {
    report.marks = [mark];
    charts.forEach(c => c.u.redraw(false));
  };
  report.rows = () => {
    offer();
    draw();
  };
})();
