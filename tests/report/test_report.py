"""The report of a result: one file that needs no other, with all of its numbers."""

import json
import re
import shutil
import subprocess
from base64 import b64decode
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

import kshell as ks
from kshell.cli.commands import run
from kshell.draw.strokes import ARROW, NEGATIVE, POSITIVE
from kshell.report import page as page_module
from kshell.report.images import Image
from kshell.report.page import content
from kshell.report.table import components, number
from kshell.report.view_data import view_data

MESHES = Path(__file__).parents[2] / "meshes"
BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)


class Read(HTMLParser):
    """Addresses, headings and cells of a page, and whether its elements are closed in order."""

    VOID = ("meta", "link", "img", "input", "br")

    def __init__(self, text):
        super().__init__()
        self.open, self.addresses, self.cells, self.heads, self.tags = [], [], [], [], set()
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        self.addresses += [value for key, value in attrs if key in ("src", "href")]
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] in ("td", "th"):
            self.cells.append(data)
        if self.open and self.open[-1] in ("h1", "h2"):
            self.heads.append(data)


@pytest.fixture(scope="module")
def cases():
    scene = ks.Scene.load(MESHES / "plate_cases.toml")
    return ks.solve(scene.changed(title='Floor <script>alert("1")</script> & roof'))


@pytest.fixture(scope="module")
def file(cases, tmp_path_factory):
    (file,) = cases.report(tmp_path_factory.mktemp("report") / "report.html")
    return Path(file)


@pytest.fixture
def no_pictures(monkeypatch):
    monkeypatch.setattr(page_module, "image", lambda result, what: Image(what, "data:,"))
    monkeypatch.setattr(page_module, "images", lambda result, few=False: [])


def test_one_file_with_all_numbers(cases, file):
    text = file.read_text("utf-8")
    page = Read(text)
    assert page.open == []
    assert all(address.startswith("data:") for address in page.addresses)
    assert not re.search(r"url\(|@import|<iframe", text)
    assert page.heads[0] == cases.title  # as text, not as a program
    for case in cases.cases.values():
        for probe in case.probes.values():
            assert number(probe["u"][2]) in page.cells
            assert set(components(probe["M"])) <= set(page.cells)
        for reaction in case.reactions.values():
            assert set(components(reaction["force"])) <= set(page.cells)
    for name in cases.cases:
        assert any(name in head for head in page.heads)
    for support in cases.scene.supports:
        assert support.kind.replace("_", " ") in page.cells


@pytest.mark.usefixtures("no_pictures")
def test_of_a_folder_it_says_the_same(cases, tmp_path, capsys):
    cases.save(tmp_path, report=True)
    live = Read((tmp_path / "report.html").read_text("utf-8"))
    assert run(["report", str(tmp_path)]) == 0
    again = Read((tmp_path / "report.html").read_text("utf-8"))
    assert str(tmp_path / "report.html") in capsys.readouterr().out
    assert again.heads == live.heads
    asked = content(cases), content(ks.Result.load(tmp_path))
    for key in ("supports", "loads", "cases", "scene", "error", "warnings", "reasons"):
        assert asked[0][key] == asked[1][key]
    assert [path.name for path in tmp_path.glob("*.html")] == ["report.html"]


def test_what_is_refused(cases, tmp_path, capsys):
    with pytest.raises(ks.InputError, match=r"\.html"):
        cases.report(tmp_path / "report.pdf")
    assert run(["solve", str(MESHES / "plate.toml"), "--report"]) == 2
    assert "-o" in capsys.readouterr().err
    assert run(["report", str(tmp_path / "nothing")]) == 2
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("no_pictures")
@pytest.mark.parametrize("name", ["plate_modes", "scordelis_lo"])
def test_of_modes_and_of_shells(name, tmp_path):
    result = ks.solve(ks.Scene.load(MESHES / f"{name}.toml"))
    (file,) = result.report(tmp_path / "report.html")
    page = Read(Path(file).read_text("utf-8"))
    for entry in result.eigen:
        assert number(entry["frequency"]) in page.cells
    for extreme in result.extremes.values():
        assert number(extreme["value"]) in page.cells
    assert page.tags >= {"canvas", "table"}


@pytest.mark.usefixtures("no_pictures")
def test_functions_stand_by_their_names(tmp_path):
    def hill(x, y, z):
        return x * 0 - 1.0

    scene = ks.Scene.load(MESHES / "plate.toml")
    result = ks.solve(scene.changed(loads=[ks.Pressure(hill)], probes={}))
    result.save(tmp_path)
    assert result.to_dict()["input"]["load"][0]["value"] == "hill(x, y, z)"
    again = ks.Result.load(tmp_path)
    assert again.scene is None
    again.report(tmp_path / "report.html")
    assert "not known" in (tmp_path / "report.html").read_text("utf-8")


def test_cases_are_drawn_at_one_scale_and_modes_each_at_its_own(cases):
    assert len({state["scale"] for state in view_data(cases)["states"]}) == 1
    modes = ks.solve(ks.Scene.load(MESHES / "plate_modes.toml"))
    largest = [np.abs(modes.fields[f"mode_{n}"]).max() for n in range(1, len(modes.eigen) + 1)]
    scales = [state["scale"] for state in view_data(modes)["states"]]
    assert np.multiply(scales, largest) == pytest.approx(0.1 * modes.mesh.size, rel=1e-12)


# put before all other programs of the page, and after them
FIRST = """<script>window.said = [];
addEventListener("error", event => said.push(event.message));
console.error = console.warn = (...words) => said.push(words.join(" "));</script>"""
LAST = """<script>
const view = window.kshellView, canvas = document.getElementById("canvas"), picked = {};
for (const [name, x] of Object.entries(PROBES)) {
  let nearest = 0, least = Infinity;
  for (let n = 0; n < view.nodes.length / 3; n++) {
    const apart = Math.hypot(...[0, 1, 2].map(k => view.nodes[3 * n + k] - x[k]));
    if (apart < least) { least = apart; nearest = n; }
  }
  picked[name] = [];
  const states = document.getElementById("frame");
  for (const option of states.options) {
    states.value = option.value;
    states.dispatchEvent(new Event("change"));
    picked[name].push(view.pick(...view.onCanvas(nearest).slice(0, 2)));
  }
}
const gl = canvas.getContext("webgl2"), size = [gl.drawingBufferWidth, gl.drawingBufferHeight];
const dots = new Uint8Array(4 * size[0] * size[1]);
function seen() {
  gl.readPixels(0, 0, ...size, gl.RGBA, gl.UNSIGNED_BYTE, dots);
  const colours = new Set();
  for (let n = 0; n < dots.length; n += 4) colours.add(dots[n] + 256 * dots[n + 1] + 65536 * dots[n + 2]);
  return colours;
}
const colours = seen(), field = document.getElementById("field"), crosses = {};
const number = of => [1, 3, 5].reduce((sum, j, k) => sum + parseInt(of.slice(j, j + 2), 16) * 256 ** k, 0);
for (const option of field.options) {
  if (!option.textContent.includes("directions")) continue;
  field.value = option.value;
  field.dispatchEvent(new Event("change"));
  const now = seen();
  crosses[option.textContent] = LOOK_FOR.map(colour => now.has(number(colour)));
}
document.body.textContent = JSON.stringify({said, picked, crosses, colours: colours.size});
</script>"""


@pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed")
def test_the_view_in_a_browser(cases, file, tmp_path):
    """Opens without a word on the console, is not blank, and reads the values of result.json."""
    text = file.read_text("utf-8")
    probes = {name: np.asarray(probe["x"]).tolist() for name, probe in cases.probes.items()}
    looked = json.dumps([POSITIVE, NEGATIVE, ARROW])
    text = text.replace("<head>", "<head>" + FIRST, 1)
    text = text.replace(
        "</body>", LAST.replace("PROBES", json.dumps(probes)).replace("LOOK_FOR", looked) + "</body>"
    )
    (tmp_path / "tried.html").write_text(text, "utf-8")
    done = subprocess.run(
        [
            BROWSER,
            "--headless=new",
            "--no-sandbox",
            "--disable-gpu",
            "--enable-unsafe-swiftshader",
            f"--user-data-dir={tmp_path / 'profile'}",
            "--dump-dom",
            f"file://{tmp_path / 'tried.html'}",
        ],
        capture_output=True,
        text=True,
        timeout=300,
        check=True,
    )
    body = re.search(r"<body>(.*)</body>", done.stdout, re.DOTALL)
    found = json.loads(body.group(1))
    assert found["said"] == []
    assert found["colours"] > 50
    assert found["crosses"]["principal moments, directions"] == [True, True, False]
    assert found["crosses"]["shear force, directions"] == [False, False, True]
    for name, states in found["picked"].items():
        assert len(states) == len(cases.cases)
        for state, case in zip(states, cases.cases.values(), strict=True):
            read = {entry["label"]: entry["value"] for entry in state["found"]}
            probe = case.probes[name]
            size = np.abs(probe["M"]).max()
            assert read["displacement z"] == pytest.approx(probe["u"][2], rel=1e-5)
            for part, value in zip(("xx", "yy", "xy"), probe["M"], strict=True):
                assert read[f"moment M {part}"] == pytest.approx(value, abs=1e-3 * size)


def test_strokes_of_the_view_lie_where_the_crosses_are():
    """Ends, sides and motions of strokes: of the length of their values, in the surface, moved as it is."""
    scene = ks.Scene.load(MESHES / "tube.toml", ["load.0.value=[0, 0, -1e-6]"])
    result = ks.solve(scene, error="off")
    (state,) = view_data(result)["states"]
    labels = [one["label"] for one in state["strokes"]]
    assert labels == [
        "principal moments, directions",
        "principal forces, directions",
        "shear force, directions",
    ]
    (line,) = [one for one in state["strokes"][1]["lines"] if one["words"] == "tension"]  # along z
    numbers = np.frombuffer(b64decode(line["numbers"]), "<f4").reshape(-1, 12)
    start, end, side, moved = numbers.reshape(-1, 4, 3).swapaxes(0, 1)
    along = (end - start) / np.linalg.norm(end - start, axis=1)[:, None]
    assert np.abs(along[:, 2]).min() > 1 - 1e-5
    middle = 0.5 * (start + end)
    assert np.linalg.norm(middle[:, :2], axis=1) == pytest.approx(np.ones(len(middle)), abs=0.02)
    assert np.abs(np.sum(side * along, axis=1)).max() < 1e-6
    assert moved == pytest.approx(result.at(middle)["u"], abs=1e-2 * float(np.abs(moved).max()))
