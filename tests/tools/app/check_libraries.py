"""The flight program carries only what flies: reads its shared libraries.

    check_libraries.py JINK JINK_LAB
"""

import re
import subprocess
import sys

ABSENT = ("ompl", "pagmo", "cairo", "gnuplot", "tbb", "boost_serialization")


def libraries(program):
    listing = subprocess.run(["ldd", program], text=True, capture_output=True, check=True).stdout
    return re.findall(r"^\s*(\S+)", listing, re.MULTILINE)


def main():
    flight, laboratory = map(libraries, sys.argv[1:3])
    faults = [f"the flight program links {name}" for name in flight if any(word in name for word in ABSENT)]
    if not any("cmavsdk" in name for name in flight):
        faults.append("the flight program lists no MAVSDK: is this its list?")
    if not any("ompl" in name for name in laboratory):
        faults.append("the laboratory links no OMPL: the check would not see it")
    print("\n".join(faults) or f"{len(flight)} libraries, none of the laboratory's")
    return 1 if faults else 0


sys.exit(main())
