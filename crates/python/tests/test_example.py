import pathlib
import subprocess
import sys

import trimesh

EXAMPLE = pathlib.Path(__file__).resolve().parents[1] / "examples" / "press.py"


def test_press(tmp_path):
    place = tmp_path / "pressed.ply"
    done = subprocess.run([sys.executable, EXAMPLE, place], capture_output=True, text=True, check=True)
    assert "volume before 4.000000, after 4.000000" in done.stdout
    pressed = trimesh.load(place, process=False)
    # A torus half sunk into the top raises it elsewhere.
    assert pressed.is_watertight and pressed.bounds[1][2] > 0.5
