# SPDX-License-Identifier: BSD-3-Clause
"""The planner and the verifier in loops of one's own."""

import threading

import numpy as np
import pytest

import jink

VOLUME = [[-5, -10, 0.5], [25, 10, 8]]


def crossing():
    return jink.tracks([[6, -6, 2], [13, 5, 2]], 0.8, velocity=[[0, 2.5, 0], [0, -1, 0]])


def fly(planner):
    """Five plans a second, each from where the one before has led to. As examples/01_plan_in_a_loop."""
    step, target = 0.2, np.array([20.0, 0.0, 2.0])
    position, velocity, previous = np.array([0.0, 0.0, 2.0]), np.zeros(3), None
    obstacles = crossing()
    flown, clearance = [position], np.inf
    for number in range(100):
        if np.linalg.norm(position - target) < 0.3:
            break
        plan = planner.plan(position, velocity, target, obstacles, previous=previous, volume=VOLUME, number=number)
        previous = plan.path.after(step)
        position, velocity = previous.position[0], previous.velocity[0]
        obstacles.position[:] += step * obstacles.velocity
        flown.append(position)
        clearance = min(clearance, (np.linalg.norm(obstacles.position - position, axis=1) - obstacles.radius).min())
    return np.array(flown), clearance - jink.Vehicle().radius


def test_flies_past_what_crosses():
    flown, clearance = fly(jink.HorizonPlanner())
    assert np.linalg.norm(flown[-1] - [20, 0, 2]) < 0.3 and clearance > 0


def test_gives_the_same_bits_at_any_number_of_threads():
    assert np.array_equal(fly(jink.HorizonPlanner())[0], fly(jink.HorizonPlanner(threads=3))[0])


def test_takes_parameters_and_says_what_is_wrong_with_them():
    with pytest.raises(jink.Error, match="^--set horizon.margn=1: .* did you mean 'horizon.margin'"):
        jink.HorizonPlanner(horizon={"margn": 1})
    assert jink.settings(horizon={"margin": 0.5}).items()["horizon.margin"] == "0.5"


@pytest.mark.parametrize(("change", "says"), [
    ({"position": [0, 0]}, "position: expected 3 numbers"),
    ({"volume": [0, 1]}, "volume: expected 2 x 3 numbers"),
    ({"generations": 0}, "generations: 0 is not at least 1"),
    ({"deadline_ms": float("nan")}, "deadline_ms: nan is not above 0"),
])
def test_refuses_a_request_by_its_name(change, says):
    request = {"position": [0, 0, 2], "velocity": [0, 0, 0], "target": [20, 0, 2], **change}
    with pytest.raises(ValueError, match=says):
        jink.HorizonPlanner().plan(**request)


def test_has_no_path_for_what_is_no_number():
    plan = jink.HorizonPlanner().plan([0, 0, np.nan], [0, 0, 0], [20, 0, 2])
    assert plan.status == "invalid" and len(plan.path) == 0 and plan.path.position.shape == (0, 3)


def test_plans_one_thing_at_a_time():
    planner, outcomes = jink.HorizonPlanner(), []

    def plan():
        try:
            planner.plan([0, 0, 2], [0, 0, 0], [20, 0, 2], crossing(), generations=20000)
            outcomes.append("planned")
        except RuntimeError as error:
            outcomes.append(str(error))

    threads = [threading.Thread(target=plan) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(outcome.partition(":")[0] for outcome in outcomes) == \
        ["at work already, in another thread or in its own callback", "planned"]


def test_tracks_are_seen_and_not_copied():
    tracks = crossing()
    tracks.position[1] = [1, 2, 3]
    assert np.array_equal(tracks.position, [[6, -6, 2], [1, 2, 3]]) and tracks.id.tolist() == [0, 1]
    assert np.shares_memory(tracks.position, tracks.position) and not np.shares_memory(tracks.radius, tracks.age)
    for bad in ({"radius": [1, 2, 3]}, {"velocity": [[1, 2]]}):
        with pytest.raises(ValueError):
            jink.tracks(**{"position": [[0, 0, 0], [1, 1, 1]], "radius": 1, **bad})
    with pytest.raises(AttributeError, match="speed"):
        jink.tracks([[0, 0, 0]], 1, speed=3)


def straight(velocity=2.0):
    path = jink.Path(2)
    path.t[:], path.position[1] = [0, 5], [5 * velocity, 0, 0]
    return path


def test_verifies_in_continuous_time():
    """Crosses the middle at 2.5 s, between the points: 1 m beside it, less both radii."""
    found = jink.verify(straight(), jink.tracks([[5, 1, 0]], 0.5))
    assert found.free and found.min_clearance == pytest.approx(0.5 - jink.Vehicle().radius, abs=1e-9)
    assert found.t_min_clearance == pytest.approx(2.5) and found.first_contact is None
    moved = jink.verify(straight(), jink.tracks([[5, 1, 0]], 0.5, velocity=[[0, -0.4, 0]]))
    assert not moved.free and 1.5 < moved.first_contact < 2.5


def test_verifies_limits_and_volume():
    vehicle = jink.Vehicle()
    vehicle.max_acceleration = 1e9
    assert jink.verify(straight(), vehicle=vehicle, velocity=[2, 0, 0]).flyable
    fast = jink.verify(straight(8.0), vehicle=vehicle, velocity=[2, 0, 0])
    assert not fast.flyable and fast.speed == pytest.approx(8.0 / vehicle.max_speed)
    assert not jink.verify(straight(), volume=[[-1, -1, -1], [4, 1, 1]]).inside_volume


def test_a_solid_is_what_is_hit():
    tracks = jink.tracks([[5, 1, 0]], 0.5)
    tracks.set_solid(0, jink.Solid.box([8, 0.2, 0.2]))
    assert tracks.radius[0] == pytest.approx(np.hypot(4, np.hypot(0.1, 0.1)))
    assert jink.verify(straight(), tracks).min_clearance == pytest.approx(1 - 0.1 - jink.Vehicle().radius, abs=1e-9)
    with pytest.raises(IndexError):
        tracks.set_solid(1, None)
    with pytest.raises(jink.Error):
        jink.Solid.box([-1, 1, 1])


def test_a_scenario_is_what_plan_knows_of_it(scenario):
    known = jink.Scenario(str(scenario("crossing")))
    assert (known.name, len(known.tracks), len(known.standing)) == ("crossing", 8, 0)
    result = jink.plan(known)
    found = jink.verify(result.path, known.tracks, known.vehicle, volume=known.volume)
    assert found.free and found.min_clearance == result.summary["min_clearance"]
