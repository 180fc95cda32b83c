"""Reports in headless Chromium, from their folders: each table of curves is drawn, a name switches its curve off, dragging
zooms, and nothing is fetched, at a desk's width and a phone's. Needs Playwright and a Chromium.

python3 tests/report_page.py FOLDER... [--pictures FOLDER]     a FOLDER has a report.html of chart, stability, plot or crosscheck
"""

import pathlib
import shutil
import sys

from browser_checks import SIZES, expect, failures
from playwright.sync_api import sync_playwright

CURVED = ("work", "drift", "order", "length", "precision", "plane", "run", "crosscheck")  # tables that must become curves


def seen(chart):
    """Returns how many pixels of a chart are drawn, and a checksum of all."""
    return chart.locator("canvas").evaluate(
        "(c) => { const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; let n = 0, sum = 0;"
        " for (let k = 0; k < d.length; k += 4) { n += d[k + 3] > 0; sum = (31 * sum + d[k] + d[k + 1]) >>> 0; } return [n, sum]; }")


def try_report(page, name, folder):
    page.goto((folder / "report.html").resolve().as_uri())
    charts, curved = page.locator(".chart"), [table for table in CURVED if (folder / f"{table}.csv").exists()]
    print(f"{name}: {charts.count()} charts, {(folder / 'report.html').stat().st_size / 1e3:.0f} kB")
    expect(f"{name}, curves", charts.count() >= len(curved), f"{charts.count()} of {curved}")
    expect(f"{name}, width", not page.evaluate("document.documentElement.scrollWidth > document.documentElement.clientWidth"))
    for n in range(charts.count()):
        chart, title = charts.nth(n), charts.nth(n).locator("h2").inner_text()
        canvas, whole, last = chart.locator("canvas"), chart.locator(".whole"), chart.locator(".legend button").last
        drawn = seen(chart)
        expect(f"{name}, {title}, drawn", drawn[0] > 500, drawn)
        for pressed in ("false", "true"):
            last.click()
            expect(f"{name}, {title}, switched", last.get_attribute("aria-pressed") == pressed)
            expect(f"{name}, {title}, drawn anew", (seen(chart) == drawn) == (pressed == "true"))
        canvas.scroll_into_view_if_needed()
        box = canvas.bounding_box()
        page.mouse.move(box["x"] + 0.4 * box["width"], box["y"] + 50)
        page.mouse.down()
        page.mouse.move(box["x"] + 0.7 * box["width"], box["y"] + 60)
        page.mouse.up()
        expect(f"{name}, {title}, zoomed", whole.is_visible())
        if whole.is_visible():
            whole.click()
        page.mouse.move(0, 0)
        expect(f"{name}, {title}, whole", whole.is_hidden() and seen(chart) == drawn, f"{seen(chart)}, {drawn}")


def main():
    arguments = sys.argv[1:]
    pictures = pathlib.Path(arguments.pop(arguments.index("--pictures") + 1)) if "--pictures" in arguments else None
    folders = [pathlib.Path(one) for one in arguments if one != "--pictures"]
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=shutil.which("chromium") or shutil.which("chromium-browser"), args=["--no-sandbox"])
        for (size, viewport), folder in ((size, folder) for size in SIZES.items() for folder in folders):
            page = browser.new_page(viewport=viewport, color_scheme="dark" if size == "phone" else "light")
            page.on("pageerror", lambda error: expect("script", False, error))
            page.on("request", lambda request: expect("nothing is fetched", request.url.startswith("file:") and request.is_navigation_request(), request.url))
            try_report(page, f"{size}, {folder.name}", folder)
            if pictures:
                pictures.mkdir(parents=True, exist_ok=True)
                page.screenshot(path=pictures / f"{size}-{folder.resolve().parent.name}-{folder.name}.png", full_page=True)
            page.close()
        browser.close()
    print("passed" if not failures else f"{len(failures)} failures")
    return bool(failures)


if __name__ == "__main__":
    sys.exit(main())
