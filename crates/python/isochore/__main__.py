"""`python -m isochore` runs the command `isochore` that was installed with this package."""

import os
import subprocess
import sys
import sysconfig


def main():
    name = "isochore.exe" if sys.platform == "win32" else "isochore"
    schemes = [sysconfig.get_default_scheme(), sysconfig.get_preferred_scheme("user")]
    for scheme in schemes:
        command = os.path.join(sysconfig.get_path("scripts", scheme), name)
        if os.path.isfile(command):
            break
    else:
        sys.exit(f"error: {name} is missing from the scripts folder of this Python; reinstall the package")
    if sys.platform == "win32":
        sys.exit(subprocess.run([command, *sys.argv[1:]]).returncode)
    os.execv(command, [command, *sys.argv[1:]])


if __name__ == "__main__":
    main()
