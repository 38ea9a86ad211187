#!/usr/bin/env python3
"""public_headers.py ROOT: what an installed header includes is installed, too."""
import pathlib
import re
import sys


def main():
    root = pathlib.Path(sys.argv[1])
    listed = re.findall(r"^  (\S+\.hpp)\)?$", (root / "cmake/public_headers.cmake").read_text(), re.MULTILINE)
    faults = [f"{header} includes {include}, which is not installed"
              for header in listed
              for include in re.findall(r'^#include "([^"]+)"', (root / header).read_text(), re.MULTILINE)
              if include not in listed]
    print("\n".join(faults) or f"{len(listed)} headers include only one another")
    sys.exit(1 if faults or not listed else 0)


if __name__ == "__main__":
    main()
