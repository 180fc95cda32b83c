"""The laboratory's page in headless Chromium: every scene and dial runs and says nothing is wrong, at a desk's width and a
phone's. Needs Playwright and a Chromium.

python3 tests/lab_page.py [--pictures FOLDER]     after docs/lab/make.sh
"""

import pathlib
import shutil
import sys

from browser_checks import SIZES, expect, failures
from playwright.sync_api import sync_playwright

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = (ROOT / "build/lab/index.html").as_uri()


def running(page):
    """Waits until the run has come on by some steps, and returns what is said to be wrong."""
    page.wait_for_function("window.laboratory && laboratory.row && laboratory.curves.x.length > 3", timeout=20000)
    return page.evaluate("document.getElementById('trouble').hidden ? '' : document.getElementById('trouble').textContent")


def try_page(page, size, picture):
    page.goto(PAGE)
    running(page)
    opened = page.evaluate("performance.now()")
    print(f"{size}: first frames after {opened / 1000:.1f} s")
    scenes = page.evaluate("SCENES.map(([name]) => name)")
    for scene in scenes:
        page.select_option("#scene", scene)
        said = running(page)
        expect(f"{size}, {scene}", said == "", said)
        page.wait_for_timeout(700)
        picture(f"{size}-{scene}")
    expect(size, not page.evaluate("document.documentElement.scrollWidth > document.documentElement.clientWidth"), "wider than the screen")
    page.select_option("#scene", "pendulum")
    for dial, value in (("dt", "0.5"), ("tolerance", "-4"), ("sweeps", "4"), ("friction", "2"), ("temperature", "400"),
                        ("friction", "0"), ("sweeps", "0"), ("speed", "1.5"), ("size", "-2")):
        page.locator(f"#{dial}").evaluate("(e, v) => { e.value = v; e.dispatchEvent(new Event('input')); }", value)
        said = running(page)
        expect(f"{size}, {dial} {value}", said == "", said)
    for method in page.evaluate("METHODS"):
        page.select_option("#method", method)
        said = running(page)
        expect(f"{size}, {method}", said == "" or method == "settle", said)  # which holds waters alone, and says so
    page.select_option("#method", "baumgarte")
    for damping in ("centred", "implicit", "lagged", "discrete"):
        page.select_option("#damping", damping)
        expect(f"{size}, {damping}", running(page) == "" or damping == "lagged")
    # The plane of gains, by the pointer and by keys; a question; a push, and what is foretold of it.
    page.locator("#triangle").click(position={"x": 100, "y": 90})
    gains = page.evaluate("[laboratory.settings.ah, laboratory.settings.bh]")
    page.locator("#triangle").press("ArrowRight")
    expect(f"{size}, keys on the plane", gains != page.evaluate("[laboratory.settings.ah, laboratory.settings.bh]"))
    page.check("#asks")
    page.locator("#triangle").click(position={"x": 120, "y": 60})
    page.wait_for_function("laboratory.question && laboratory.asked.x.length > 3")
    page.uncheck("#asks")
    page.click("#push")
    page.wait_for_function("laboratory.curves.foretold.filter(Number.isFinite).length > 20")
    apart = page.evaluate("(() => { const c = laboratory.curves, k = c.x.findIndex((x, n) => n > 3 && c.foretold[n] > 1e-9);"
                          " return Math.abs(c.rms[k] / c.foretold[k] - 1); })()")
    expect(f"{size}, what is foretold", apart < 0.05, apart)
    page.click("#keep")
    expect(f"{size}, kept", page.evaluate("laboratory.kept.length === 1"))
    for story in range(3):
        page.locator("#chapters button").nth(story).click()
        step = 0
        while True:
            page.wait_for_timeout(1500)
            said = running(page)
            expect(f"{size}, story {story + 1}.{step + 1}", said == "" or (story == 2 and "try" in said), said)
            picture(f"{size}-story{story + 1}-{step + 1}")
            if page.locator("#next").is_disabled():
                break
            page.click("#next")
            step += 1
    page.goto(PAGE + "#scene=fold&method=rattle&dt=2")
    page.reload()
    running(page)
    expect(f"{size}, link", page.evaluate("laboratory.settings.scene === 'fold' && laboratory.settings.dt === 2"))


def main():
    folder = pathlib.Path(sys.argv[2]) if "--pictures" in sys.argv else None
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        for size, viewport in SIZES.items():
            page = browser.new_page(viewport=viewport, color_scheme="dark" if size == "phone" else "light")
            page.on("pageerror", lambda error: expect("script", False, error))

            def picture(name):
                if folder:
                    folder.mkdir(parents=True, exist_ok=True)
                    page.screenshot(path=folder / f"{name}.png", full_page=True)

            try_page(page, size, picture)
        browser.close()
    print("passed" if not failures else f"{len(failures)} failures")
    return bool(failures)


if __name__ == "__main__":
    sys.exit(main())
