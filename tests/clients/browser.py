#!/usr/bin/env python3
"""Looks at the pages of runs with a browser: nothing on the console, curves and particles drawn, turned by a drag, played by a key, light and dark.

Usage: tests/clients/browser.py [PATH OF perigrain] [quick | FOLDER FOR PICTURES]. It needs Python with `playwright` and `axe-playwright-python` (pip,
as `tests/clients/run.sh fetch` gets them), and a Chromium: playwright's own (`playwright install chromium`) or the system's. Without them it says so and
succeeds. `quick`, as in CI: the page of the run by day, that of log and dump by night.
"""

import os
import shutil
import subprocess
import sys
import tempfile

try:
    from playwright.sync_api import sync_playwright
except ImportError:
    print("browser: skipped, playwright is not installed (pip install playwright axe-playwright-python)")
    sys.exit(0)
try:
    from axe_playwright_python.sync_playwright import Axe
except ImportError:
    Axe = None

TOP = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", ".."))
ARGS = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--no-sandbox"]

DECK = """units si
atom_style sphere
boundary p p f
region box block 0 1 0 1 -0.1 1.6 units box
create_box 2 box
lattice sc 0.1
region low block 0.02 0.98 0.02 0.98 0.05 0.95 units box
create_atoms 1 region low
set group all type/fraction 2 0.3 42
set type 1 diameter 0.09 density 1000
set type 2 diameter 0.07 density 1000
pair_style granular
pair_coeff * * hertz 1e6 0.5 tangential linear_nohistory 0 0 damping velocity
fix 1 all nve/sphere
fix g all gravity 9.81 vector 0 0 -1
fix w all wall/gran granular hertz 1e6 0.5 tangential linear_nohistory 0 0 damping velocity zplane 0 1.5
thermo_style custom step time atoms ke
thermo 50
timestep 1e-4
print "</script><script>alert(1)</script>"
dump p all image 1000 p.*.png type type size 160 120
dump d all custom 200 d.dump id type x y z vx vy vz radius
run 2000
"""

# Pixels of a canvas that are not like its corner, drawn anew so that they are there to be read.
PIXELS = """canvas => {
  const copy = document.createElement("canvas");
  [copy.width, copy.height] = [canvas.width, canvas.height];
  const c = copy.getContext("2d");
  c.drawImage(canvas, 0, 0);
  const { data } = c.getImageData(0, 0, copy.width, copy.height);
  let n = 0, sum = 0;
  for (let i = 0; i < data.length; i += 4) if (data[i + 3] > 0) {
    n += 1;
    sum = (sum + (i + 1) * (data[i] + 3 * data[i + 1] + 7 * data[i + 2])) % 1000000007;
  }
  return [n, sum];
}"""


def particles(page):
    """How many pixels the particles take, and a number that changes with them."""
    # The picture is only there in the frame in which it is drawn.
    return page.evaluate(
        "() => new Promise(done => { dispatchEvent(new Event('resize')); const canvas = document.getElementById('view');"
        f"report.view.draw(); done(({PIXELS})(canvas)); }})"
    )


def settled(page):
    # No expression may be evaluated on a page that forbids it: the element is waited for instead.
    page.locator("#wait").wait_for(state="hidden", timeout=60_000)
    page.wait_for_timeout(300)


def look(browser, url, name, scheme, pictures):
    problems = []
    page = browser.new_page(viewport={"width": 1280, "height": 900}, color_scheme=scheme)
    page.on("console", lambda m: problems.append(f"console: {m.text}") if m.type in ("error", "warning") and "GPU stall" not in m.text else None)
    page.on("pageerror", lambda e: problems.append(f"error: {e}"))
    page.on("request", lambda r: problems.append(f"asks for {r.url[:80]}") if not r.url.startswith(("file:", "data:", "blob:")) else None)
    page.on("dialog", lambda d: (problems.append(f"dialog: {d.message}"), d.dismiss()))
    page.goto(url)
    settled(page)
    charts = page.locator("#charts canvas")
    if charts.count() == 0:
        problems.append("no curves")
    for k in range(charts.count()):
        if charts.nth(k).evaluate(PIXELS)[0] < 200:
            problems.append(f"curve {k} is empty")
    last = particles(page)
    if last[0] < 5000:
        problems.append(f"particles take {last[0]} pixels")
    canvas = page.locator("#view")
    canvas.scroll_into_view_if_needed()
    box = canvas.bounding_box()
    page.mouse.move(box["x"] + 300, box["y"] + 200)
    page.mouse.down()
    page.mouse.move(box["x"] + 420, box["y"] + 240, steps=4)
    page.mouse.up()
    if particles(page) == last:
        problems.append("a drag does not turn the particles")
    canvas.focus()
    for key in ["ArrowLeft", "+", "-", ",", "x", "y", "z", "Home"]:
        before = particles(page)
        page.keyboard.press(key)
        page.wait_for_timeout(60)
        if key != "Home" and particles(page) == before:
            problems.append(f"key {key} changes nothing")
    before = page.locator("#now").text_content()
    page.keyboard.press(" ")
    page.wait_for_timeout(700)
    page.keyboard.press(" ")
    if page.locator("#now").text_content() == before:
        problems.append("space does not play")
    full = particles(page)
    page.locator("#cut").select_option("x")
    page.wait_for_timeout(60)
    if not 0 < particles(page)[0] < full[0]:
        problems.append("a cut takes nothing away")
    page.locator("#colour").select_option("type")
    page.wait_for_timeout(60)
    if Axe is None:
        print("  axe-playwright-python is not installed: accessibility is not looked at")
    else:
        for v in Axe().run(page).response["violations"]:
            if v["impact"] in ("serious", "critical"):
                problems.append(f"axe: {v['impact']} {v['id']}: {v['help']}: {v['nodes'][0]['html'][:120]}")
    if pictures:
        page.locator("#cut").select_option("nothing")
        page.screenshot(path=os.path.join(pictures, f"{name}-{scheme}.png"), full_page=True)
    page.close()
    print(f"  {name}, {scheme}: " + ("\n    ".join(["", *problems]) if problems else "well"))
    return len(problems)


def main():
    program = os.path.realpath(sys.argv[1] if len(sys.argv) > 1 else os.path.join(TOP, "target/debug/perigrain"))
    quick = sys.argv[2:] == ["quick"]
    pictures = sys.argv[2] if len(sys.argv) > 2 and not quick else None
    if pictures:
        os.makedirs(pictures, exist_ok=True)
    wrong = 0
    with tempfile.TemporaryDirectory() as home, sync_playwright() as play:
        with open(os.path.join(home, "in.grains"), "w") as deck:
            deck.write(DECK)
        for words in (["-in", "in.grains", "-screen", "none", "-report", "run.html"], ["report", "log.lammps", "d.dump", "-o", "read.html"]):
            subprocess.run([program, *words], cwd=home, check=True, stdout=subprocess.DEVNULL)
        try:
            own = None if os.path.exists(play.chromium.executable_path) else shutil.which("chromium") or shutil.which("google-chrome")
            browser = play.chromium.launch(executable_path=own, args=ARGS)
        except Exception as e:
            print(f"browser: skipped, no Chromium starts here ({str(e).splitlines()[0]})")
            return 0
        both = [("run", "light"), ("read", "dark")]
        for name, scheme in both if quick else [*both, ("run", "dark"), ("read", "light")]:
            wrong += look(browser, f"file://{home}/{name}.html", name, scheme, pictures)
        browser.close()
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
