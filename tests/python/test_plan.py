# SPDX-License-Identifier: BSD-3-Clause
"""jink.plan beside `jink plan`."""

import threading
import time

import numpy as np
import pytest
from conftest import without_wall_times

import jink


@pytest.mark.parametrize("mode", ["horizon", "paper"])
@pytest.mark.parametrize("name", ["crossing", "table2-5", "table12-3"])
def test_gives_the_commands_summary(command, scenario, name, mode):
    said = command.summary("plan", scenario(name), "--mode", mode, "--seed", 7)
    result = jink.plan(scenario(name), mode, 7)
    assert without_wall_times(result.summary) == without_wall_times(said)
    assert result.reached and result.text.startswith(f"scenario {said['scenario']}: reached")


def test_takes_every_option_of_the_command(command, scenario):
    said = command.summary("plan", scenario("crossing"), "--threads", 2, "--slaves", 3, "--sharing", 2, "--population", 30,
                           "--iterations", 50, "--waypoints", 5, "--set", "horizon.margin=0.25", "--set",
                           "horizon.guide=false", "--algorithm", "pmomvo")
    options = {"threads": 2, "slaves": 3, "sharing": 2, "population": 30, "iterations": 50, "waypoints": 5,
               "algorithm": "pmomvo"}
    for changes in ({"horizon": {"margin": 0.25, "guide": False}}, {"horizon.margin": np.float64(0.25), "horizon.guide": False},
                    {"set": ["horizon.margin=0.25", "horizon.guide=false"]},
                    {"set": {"horizon.margin": 0.25, "horizon.guide": np.bool_(False)}}):
        assert without_wall_times(jink.plan(scenario("crossing"), **options, **changes).summary) == without_wall_times(said)


def test_takes_a_file_of_parameters_and_a_scenario_that_was_read(command, scenario, tmp_path):
    text = (jink.config_folder() / "planner.yaml").read_text()
    parameters = tmp_path / "mine.yaml"
    parameters.write_text(text.replace("margin: 0.35", "margin: 0.2"))
    said = command.summary("plan", scenario("crossing"), "--config", parameters)
    result = jink.plan(jink.Scenario(str(scenario("crossing"))), config=parameters)
    assert without_wall_times(result.summary) == without_wall_times(said)


@pytest.mark.parametrize(("options", "words"), [
    ({"slaves": 70}, ["--slaves", "70"]),
    ({"seed": -1}, ["--seed", "-1"]),
    ({"threads": 0}, ["--threads", "0"]),
    ({"mode": "fast"}, ["--mode", "fast"]),
    ({"deadline_ms": 0}, ["--deadline-ms", "0"]),
    ({"waypoints": 50}, ["--waypoints", "50"]),
    ({"population": 1}, ["--population", "1"]),
    ({"config": ""}, ["--config", ""]),
    ({"config": "nowhere.yaml"}, ["--config", "nowhere.yaml"]),
    ({"horizon": {"margn": 0.1}}, ["--set", "horizon.margn=0.1"]),
    ({"horizon.margin": -1}, ["--set", "horizon.margin=-1"]),
    ({"margin": 1}, ["--set", "margin=1"]),
    ({"set": ["horizon.margin"]}, ["--set", "horizon.margin"]),
    ({"optimizer": {"slaves": 9, "population": 8}}, ["--set", "optimizer.slaves=9", "--set", "optimizer.population=8"]),
])
def test_refuses_in_the_commands_words(command, scenario, options, words):
    with pytest.raises(jink.Error) as refused:
        jink.plan(scenario("crossing"), **options)
    assert str(refused.value) == command.error("plan", scenario("crossing"), *words)
    assert isinstance(refused.value, ValueError)


@pytest.mark.parametrize("text", ["", "format: jink-scenario/2\n", "format: jink-scenario/1\nname: x\nradios: 3\n"])
def test_refuses_a_scenario_in_the_commands_words(command, tmp_path, text):
    file = tmp_path / "bad.yaml"
    file.write_text(text)
    for path in (file, tmp_path / "none.yaml"):
        with pytest.raises(jink.Error) as refused:
            jink.plan(path)
        assert str(refused.value) == command.error("plan", path)


@pytest.mark.parametrize("options", [{"slaves": "many"}, {"mode": 3}, {"set": "horizon.margin=1"}, {"seed": 1.5}])
def test_refuses_a_wrong_type_by_its_name(scenario, options):
    with pytest.raises(TypeError, match=next(iter(options))):
        jink.plan(scenario("crossing"), **options)


def test_says_that_the_laboratorys_algorithms_are_elsewhere(scenario):
    with pytest.raises(jink.Error, match="^--algorithm: momvo .* `jink-lab plan` has it$"):
        jink.plan(scenario("crossing"), algorithm="momvo")


def test_shows_the_path_where_it_is(scenario):
    result = jink.plan(scenario("crossing"))
    path = result.path
    listed = np.array(result.summary["path"])
    assert np.array_equal(path.t, listed[:, 0]) and np.array_equal(path.position, listed[:, 1:])
    assert np.shares_memory(path.position, result.plan.path.position) and len(path) == len(listed)
    positions = path.position
    expected = positions.copy()
    del result, path
    assert np.array_equal(positions, expected)  # what is seen lives as long as it is seen


def test_lets_other_threads_run(scenario):
    ticks, done = [], threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.001)

    thread = threading.Thread(target=tick)
    thread.start()
    begun = time.monotonic()
    jink.plan(scenario("table2-5"), "paper", iterations=3000, threads=1)
    ended = time.monotonic()
    done.set()
    thread.join()
    assert len([t for t in ticks if begun < t < ended]) > 10


def test_finds_the_shipped_files_unless_told_of_others(monkeypatch, tmp_path, scenario):
    inside = jink.config_folder()
    assert inside.parent.name == "jink" and (inside / "planner.yaml").exists() and (inside / "vehicles/px4.yaml").exists()
    crossing = scenario("crossing")
    monkeypatch.setenv("JINK_CONFIG_DIR", str(tmp_path))
    assert jink.config_folder() == tmp_path
    with pytest.raises(jink.Error, match=f"^{tmp_path}/planner.yaml: cannot read"):
        jink.plan(crossing)
