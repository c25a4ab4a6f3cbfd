"""``canon choose`` from its arguments to its table, lines and exit status."""

import json

import pytest

from canon.cli import main


def choose(*arguments):
    return main(["choose", "henon-heiles", "--method", "srkn-6b", "--method", "taylor", *arguments])


def test_the_table_answers_first_and_says_how_to_run_it(capsys):
    assert choose("--accuracy", "1e-6", "--periods", "2000") == 0
    printed = capsys.readouterr().out
    assert "energy to 1e-06 over t = 12566.4: " in printed.splitlines()[1]
    command = printed.splitlines()[-1].removeprefix("to run it: canon ").split()
    assert main([*command, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["bound"] <= 1e-6


def test_lines_are_json_with_the_choice_first(capsys):
    assert choose("--accuracy", "1e-6", "--span", "500", "--json") == 0
    lines = [json.loads(line, parse_constant=pytest.fail) for line in capsys.readouterr().out.splitlines()]
    assert [line["chosen"] for line in lines] == [True] + [False] * (len(lines) - 1)
    assert lines[0]["keeps"]
    assert lines[0]["predicted_error"] <= 1e-6
    assert lines[0]["span"] == 500.0


@pytest.mark.slow
def test_what_nothing_keeps_is_an_exit_status(capsys):
    arguments = ["choose", "henon-heiles", "--accuracy", "1e-17", "--periods", "300", "--method", "rk4"]
    assert main(arguments) == 1
    assert "no method keeps it; the best reaches" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["henon-heile"], "did you mean henon-heiles"),
        (["kepler", "--accuracy", "2"], "between 0 and 0.1"),
        (["kepler", "--periods", "-1"], "positive, finite duration"),
        (["kepler", "--observable", "spin"], "has no constant 'spin'"),
        (["kepler", "--start", "e=2"], "has no start 'e=2'"),
        (["kepler", "--set", "mu"], "--set mu: write a parameter's name"),
        (["kepler", "--method", "leapfrog"], "leapfrog"),
    ],
)
def test_bad_usage_says_what_to_do(arguments, told, capsys):
    assert main(["choose", *arguments]) == 2
    assert told in capsys.readouterr().err
