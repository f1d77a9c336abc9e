# SPDX-License-Identifier: BSD-3-Clause
"""PMOMVO on problems of one's own."""

import threading

import numpy as np
import pytest

import jink

LOWER, UPPER = np.zeros(10), np.ones(10)


def zdt1(x):
    """Zitzler, Deb and Thiele (2000): the front is f2 = 1 - sqrt(f1)."""
    g = 1 + 9 * x[:, 1:].mean(axis=1)
    return np.stack([x[:, 0], g * (1 - np.sqrt(x[:, 0] / g))], axis=1)


def test_finds_the_front():
    front = jink.Pmomvo(10, 2, population=60, iterations=200).run(zdt1, LOWER, UPPER)
    assert front.evaluations == 60 * 200 and front.generations == 200 and not front.deadline_reached
    assert front.x.shape == (len(front), 10) and front.f.shape == (len(front), 2) and len(front) > 100
    assert np.array_equal(front.f, zdt1(front.x)) and not front.violation.any()
    assert np.abs(front.f[:, 1] - (1 - np.sqrt(front.f[:, 0]))).max() < 0.05
    assert not front.f.flags.writeable


def test_gives_the_same_bits_at_any_number_of_threads():
    optimizer = jink.Pmomvo(10, 2, population=60, iterations=50, slaves=4)
    fronts = [optimizer.run(zdt1, LOWER, UPPER, seed=3, threads=threads) for threads in (1, 3, 1)]
    assert all(np.array_equal(front.x, fronts[0].x) for front in fronts)
    assert not np.array_equal(optimizer.run(zdt1, LOWER, UPPER, seed=4).x, fronts[0].x)


def test_keeps_constraints():
    def constrained(x):
        return zdt1(x), np.maximum(0, 0.5 - x[:, 0])

    front = jink.Pmomvo(10, 2, iterations=100).run(constrained, LOWER, UPPER)
    assert front.f[:, 0].min() >= 0.5 and not front.violation.any()


def test_begins_where_it_is_told():
    best = np.zeros(10)
    front = jink.Pmomvo(10, 2, iterations=1).run(zdt1, LOWER, UPPER, initial=best)
    assert np.array_equal(front.f[0], [0, 1])


def test_shows_all_universes_of_a_slave_at_once():
    seen = []

    def evaluate(x):
        seen.append((x.shape, x.flags.writeable, x.flags.owndata))
        return zdt1(x)

    jink.Pmomvo(10, 2, population=40, slaves=2, sharing=0, iterations=3).run(evaluate, LOWER, UPPER)
    assert seen == [((20, 10), False, False)] * 6


@pytest.mark.parametrize(("evaluate", "error", "says"), [
    (lambda x: zdt1(x)[:, :1], TypeError, r"the objectives: expected an array of 10 x 2 numbers, not ndarray of shape \(10, 1\)"),
    (lambda x: None, TypeError, "the objectives: .* not NoneType"),
    (lambda x: (zdt1(x), np.zeros(3)), TypeError, r"the violations: expected an array of 10 numbers, not ndarray of shape \(3,\)"),
    (lambda x: 1 / 0, ZeroDivisionError, "division by zero"),
    (lambda x: x.__setitem__(0, 1), ValueError, "read-only"),
])
@pytest.mark.parametrize("threads", [1, 2])
def test_what_the_function_raises_comes_out(evaluate, error, says, threads):
    optimizer = jink.Pmomvo(10, 2, population=20, slaves=2)
    with pytest.raises(error, match=says):
        optimizer.run(evaluate, LOWER, UPPER, threads=threads)
    assert len(optimizer.run(zdt1, LOWER, UPPER)) > 0  # and it can be used again


def test_is_not_run_from_its_own_function():
    optimizer = jink.Pmomvo(10, 2)
    with pytest.raises(RuntimeError, match="at work already"):
        optimizer.run(lambda x: optimizer.run(zdt1, LOWER, UPPER), LOWER, UPPER)


def test_what_is_no_number_is_worst():
    def holes(x):
        f = zdt1(x)
        f[x[:, 0] < 0.3] = np.nan
        return f

    assert jink.Pmomvo(10, 2, iterations=50).run(holes, LOWER, UPPER).f[:, 0].min() >= 0.3


@pytest.mark.parametrize(("arguments", "says"), [
    ({"dimension": 0}, "dimension: Value 0 not in range 1 to 100000"),
    ({"objectives": 4}, "objectives: Value 4 not in range 1 to 3"),
    ({"population": 3}, "optimizer.population.* is smaller than the number of slaves"),
    ({"popul": 3}, "unknown key"),
    ({"archive": 2}, "archive: 2 does not hold the extremes"),
])
def test_refuses_a_shape_or_parameter_by_its_name(arguments, says):
    with pytest.raises(jink.Error, match=says):
        jink.Pmomvo(**{"dimension": 10, "objectives": 2, **arguments})


@pytest.mark.parametrize(("arguments", "says"), [
    ({"lower": [0.0]}, "lower, upper: expected 10 numbers each, not 1 and 10"),
    ({"upper": -UPPER}, "of variable 0: 0.0* to -1.0* is no range"),
    ({"upper": UPPER * np.inf}, "is no range"),
    ({"initial": [[1.0, 2.0]]}, "initial: expected rows of 10 numbers, not 2"),
    ({"generations": 0}, "generations: 0 is not at least 1"),
    ({"deadline_ms": -1.0}, "deadline_ms: -1.0* is not above 0"),
    ({"threads": 0}, "--threads: Value 0 not in range 1 to 256"),
])
def test_refuses_an_argument_by_its_name(arguments, says):
    with pytest.raises(jink.Error, match=says):
        jink.Pmomvo(10, 2).run(**{"evaluate": zdt1, "lower": LOWER, "upper": UPPER, **arguments})


def test_slaves_run_beside_each_other_where_the_function_lets_them():
    together = threading.Barrier(2, timeout=60)

    def evaluate(x):
        together.wait()  # both slaves are in here, or nobody comes out
        return zdt1(x)

    jink.Pmomvo(10, 2, population=20, slaves=2, sharing=0, iterations=3).run(evaluate, LOWER, UPPER, threads=2)
