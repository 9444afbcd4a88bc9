// A page that is open during its run: requests the state, takes in rows and snapshots, sends the reader's requests.
"use strict";
(() => {
  if (!report.data.live) return;
  const $ = id => document.getElementById(id);
  const token = new URLSearchParams(location.search).get("token") || "";
  const ask = (path, since = 0, method = "GET") =>
    fetch(`${path}?token=${encodeURIComponent(token)}&since=${since}`, { method, cache: "no-store" }).then(answer => {
      if (!answer.ok) throw new Error(answer.statusText);
      return answer;
    });
  const { curves } = report.data;
  const MOST = 100, BYTES = 4e8;
  let seen = 0, rows = 0, over = false, gone = 0, status = "waiting";

  const buttons = () => {
    const none = over || status === "waiting" || status === "stopping";
    $("pause").textContent = status === "paused" ? "Continue" : "Pause the run";
    $("pause").disabled = $("stop").disabled = none;
    $("step").disabled = none || status !== "paused";
  };
  const wish = path => ask(path, 0, "POST").then(look).catch(() => {});
  $("pause").addEventListener("click", () => wish(status === "paused" ? "/go" : "/pause"));
  $("step").addEventListener("click", () => wish("/step"));
  $("stop").addEventListener("click", () => wish("/stop"));

  const take = list => {
    list.forEach(row => {
      curves.steps.push(row.step);
      curves.times.push(row.time);
      row.columns.forEach((name, k) => {
        let column = curves.columns.find(c => c.name === name);
        if (!column) curves.columns.push(column = { name, values: Array(rows).fill(null) });
        column.values.push(row.values[k]);
      });
      rows += 1;
      curves.columns.forEach(c => { if (c.values.length < rows) c.values.push(null); });
    });
    if (list.length) report.rows();
  };
  const picture = async () => {
    const buffer = await (await ask("/frame", seen)).arrayBuffer();
    if (!buffer.byteLength || !report.view) return;
    const size = new DataView(buffer).getUint32(0, true);
    const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, size)));
    const { frames, shown } = report.view, follows = shown() < 0 || shown() >= frames.length - 1;
    const frame = report.view.unpack(head.frame, await report.view.inflate(new Uint8Array(buffer, 4 + size)), null);
    seen = head.id;
    const last = frames[frames.length - 1];
    const at = last && last.meta.step === frame.meta.step ? frames.length - 1 : frames.length;
    report.view.arrived(at, frame);
    const bytes = frames.reduce((sum, f) => sum + 10 * f.meta.n, 0);
    // Every other one goes, so that a long run stays whole.
    if (frames.length > MOST || bytes > BYTES) for (let k = frames.length - 2; k > 0; k -= 2) frames.splice(k, 1);
    report.view.say("");
    report.view.settled();
    if (follows) report.view.show(frames.length - 1);
  };
  const look = async () => {
    const state = await (await ask("/state", rows)).json();
    take(state.rows);
    status = state.status;
    await picture();
    over = status === "over" && !state.rows.length;
    const words = { waiting: "Nothing runs at the moment.", running: "The run is in progress", paused: "The run is paused", stopping: "The run ends", over: "The run is over; this page keeps what it has seen." };
    $("status").textContent = ["waiting", "over"].includes(status) ? words[status] : `${words[status]}: ${state.done} of ${state.total} steps.`;
    buttons();
  };
  const beat = async () => {
    try {
      await look();
      gone = 0;
    } catch {
      gone += 1;
      if (gone > 3) {
        over = true;
        $("status").textContent = "The program has ended; this page keeps what it has seen.";
        buttons();
      }
    }
    if (!over) setTimeout(beat, 500);
    else ask("/frame", seen).catch(() => {});
  };
  buttons();
  beat();
})();
