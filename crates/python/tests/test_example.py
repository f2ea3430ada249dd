import pathlib
import subprocess
import sys

import trimesh

EXAMPLE = pathlib.Path(__file__).resolve().parents[1] / "examples" / "press.py"


def test_press(tmp_path):
    output = tmp_path / "pressed.ply"
    done = subprocess.run([sys.executable, EXAMPLE, output], capture_output=True, text=True, check=True)
    assert "volume before 4.000000, after 4.000000" in done.stdout
    pressed = trimesh.load(output, process=False)
    # A torus that is half sunk into the top raises the rest of it.
    assert pressed.is_watertight and pressed.bounds[1][2] > 0.5
