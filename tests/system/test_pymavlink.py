# SPDX-License-Identifier: BSD-3-Clause
"""pymavlink, which shares no code with the simulator, arms, is refused and granted modes, takes off and lands.

    test_pymavlink.py JINK INSTANCE
"""

import pathlib
import sys

from flight import CONFIG, Arena, check, interrupt, main, wait

CLIENT = pathlib.Path(__file__).resolve().parents[1] / "sim" / "mavlink" / "pymavlink_client.py"


def test(jink, instance):
    with Arena(jink, int(instance)) as arena:
        sim = arena.sim(CONFIG / "scenarios" / "crossing.yaml")
        client = arena.start("client", [sys.executable, CLIENT, "--port", 14540 + arena.instance])
        status = wait(client, 200)
        print((arena.folder / "client.txt").read_text(), flush=True)
        check(status == 0, "every check of the client holds")
        check(interrupt(sim) == 0, "sim ends with exit status 0")


main(test)
