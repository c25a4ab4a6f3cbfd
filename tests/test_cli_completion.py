"""``canon completion``: what a shell offers is what the commands read."""

import re
import shlex
import subprocess

import pytest

from canon.cli import COMMANDS, main
from canon.command import completion
from canon.flow.method.method_text import method_named
from canon.kernel.schemes.splitting_schemes import SCHEMES
from canon.scene import names

SHELLS = ("bash", "zsh", "fish", "tcsh", "powershell")
ACTIONS = ("run", "resume", "status", "export", "report", "mend", "merge")
PLACES = [(), *((name,) for name in COMMANDS), *(("study", action) for action in ACTIONS)]


@pytest.fixture
def script(capsys):
    def printed(shell):
        assert main(["completion", shell]) == 0
        return capsys.readouterr().out

    return printed


def offered(script, *words, cwd=None):
    """What bash offers for the last of the words, by the function that the script registers for canon."""
    line = " ".join(shlex.quote(word) for word in words)
    asked = (
        f"COMP_WORDS=({line}); COMP_CWORD={len(words) - 1}\n"
        '[[ $(complete -p canon) =~ -F\\ ([^ ]+) ]]; "${BASH_REMATCH[1]}" canon\n'
        'printf "%s\\n" "${COMPREPLY[@]}"'
    )
    done = subprocess.run(
        ["bash", "--norc", "-c", f"{script}\n{asked}"], capture_output=True, text=True, check=True, cwd=cwd
    )
    assert done.stderr == ""
    return set(done.stdout.split("\n")) - {""}


def test_bash_offers_what_can_follow(script):
    bash = script("bash")
    assert offered(bash, "canon", "") == set(COMMANDS)
    assert offered(bash, "canon", "dr") == {"drift"}
    assert offered(bash, "canon", "drift", "") == {*names(), "list"}
    assert offered(bash, "canon", "drift", "kep") == {"kepler"}
    assert offered(bash, "canon", "drift", "kepler", "--method", "kahan-li-") == {"kahan-li-6", "kahan-li-8"}
    assert offered(bash, "canon", "drift", "kepler", "--precision", "d") == {"double", "double-double"}
    assert offered(bash, "canon", "drift", "kepler", "--step", "") == set()
    assert offered(bash, "canon", "drift", "kepler", "--json", "--method", "gauss-8") == {"gauss-8"}
    assert offered(bash, "canon", "study", "") == set(ACTIONS)
    assert offered(bash, "canon", "study", "r") == {"run", "resume", "report"}
    assert offered(bash, "canon", "study", "resume", "--s") == set()
    assert offered(bash, "canon", "study", "run", "--s") == {"--store", "--share"}
    assert offered(bash, "canon", "completion", "") == set(SHELLS)


def test_bash_offers_files_where_files_are_read_or_written(script, tmp_path):
    (tmp_path / "my answers.toml").touch()
    bash = script("bash")
    for words in (
        ["check"],
        ["check", "--html"],
        ["drift", "kepler", "--plot"],
        ["study", "run", "--store"],
        ["study", "export", "some.sqlite"],
    ):
        assert offered(bash, "canon", *words, "my", cwd=tmp_path) == {"my answers.toml"}
    for words in (["choose"], ["drift", "kepler", "--step"], ["study", "run", "--jobs"]):
        assert offered(bash, "canon", *words, "my", cwd=tmp_path) == set()


def options_in_the_help(capsys, words):
    with pytest.raises(SystemExit):
        main([*words, "--help"])
    return set(re.findall(r"^  (?:-h, )?(--[\w-]+)", capsys.readouterr().out, re.MULTILINE))


def options_offered(script, words):
    """The options that each script offers after some words; tcsh has one list for all places."""
    place = "_".join(("_shtab_canon", *words))
    (zsh,) = re.findall(rf"^{place}_options=\(\n(.*?)\n\)$", script("zsh"), re.MULTILINE | re.DOTALL)
    (powershell,) = re.findall(rf"^    '{place}' = @\('-h', (.*)\)$", script("powershell"), re.MULTILINE)
    fish = re.escape(" ".join(("_shtab_canon_using", *words)))
    return {
        "bash": offered(script("bash"), "canon", *words, "--"),
        "zsh": set(re.findall(r'[",*)](--[\w-]+)[\[}]', zsh)),
        "powershell": set(re.findall(r"'(--[\w-]+)'", powershell)),
        "fish": {
            f"--{name}"
            for name in re.findall(
                rf"^complete -c canon -n '?{fish}'? (?:-s \w )?-l ([\w-]+)", script("fish"), re.MULTILINE
            )
        },
    }


@pytest.mark.parametrize("words", PLACES, ids=" ".join)
def test_every_option_of_the_help_is_offered_in_every_shell(words, script, capsys):
    shown = options_in_the_help(capsys, words)
    assert "--help" in shown
    assert options_offered(script, words) == dict.fromkeys(("bash", "zsh", "powershell", "fish"), shown)
    (tcsh,) = re.findall(r"'c/--/\((.*?)\)/'", script("tcsh"))
    assert shown <= {f"--{name}" for name in tcsh.split()}


def test_every_scene_and_method_is_offered_in_every_shell(script):
    for text in map(script, SHELLS):
        assert all(re.search(rf"(?<![\w-]){name}(?![\w-])", text) for name in (*names(), *SCHEMES))


def test_quotes_in_the_help_stay_quotes(script):
    """The help says one's; bash reads its script to the end, and each word of the others is closed again."""
    assert subprocess.run(["bash", "-n", "-c", script("bash")], check=False).returncode == 0
    assert "show one'\"'\"'s equations" in script("zsh")
    assert "show one'\"'\"'s equations" in script("fish")
    assert "show one''s equations" in script("powershell")


def test_another_shell_is_refused(capsys):
    with pytest.raises(SystemExit):
        main(["completion", "nushell"])
    told = capsys.readouterr().err
    assert "'nushell'" in told
    assert all(shell in told for shell in SHELLS)


@pytest.mark.parametrize("name", completion._methods())
def test_every_method_that_is_offered_is_one(name):
    said, offered_as = (re.sub(r"\W", "", text.lower()) for text in (str(method_named(name)), name))
    assert said.startswith(offered_as)
