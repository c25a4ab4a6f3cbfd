"""Completion scripts: what can follow where, in the language of each shell."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

__all__ = ["SHELLS", "Option", "Place", "bash", "fish", "zsh"]


@dataclass(frozen=True)
class Option:
    """An option: its names, what it does, and the values it takes where they are known."""

    names: tuple[str, ...]
    about: str
    takes_value: bool = False
    values: tuple[str, ...] = ()
    files: bool = False


@dataclass(frozen=True)
class Place:
    """Where one is after some words, what may follow there with what it does, and the options."""

    words: tuple[str, ...]
    following: Mapping[str, str]
    options: tuple[Option, ...]
    files: bool = False

    @property
    def at(self) -> str:
        """The words as they are written."""
        return " ".join(self.words)

    @property
    def flags(self) -> dict[str, str]:
        """The names of the options with what they do."""
        return {name: option.about for option in self.options for name in option.names}


class _Offers(Protocol):
    """How a shell is told what it may offer: some words, and files."""

    def __call__(self, words: Mapping[str, str], *, files: bool) -> str: ...


def bash(places: Sequence[Place]) -> str:
    """Return a script for bash 3.2 or later."""
    return _with_cases(_BASH, places, _bash_offers)


def zsh(places: Sequence[Place]) -> str:
    """Return a script for zsh, to be sourced or found along ``fpath``."""
    return _with_cases(_ZSH, places, _zsh_offers)


def _with_cases(frame: str, places: Sequence[Place], offers: _Offers) -> str:
    """Fill a frame with cases: which place the words lead to, what an option takes, what a place offers."""
    takes: dict[str, list[str]] = {}
    for place in places:
        for option in (each for each in place.options if each.takes_value):
            offered = offers(dict.fromkeys(option.values, ""), files=option.files)
            takes.setdefault(offered, []).extend(f'"{place.at} {name}"' for name in option.names)
    cases = {
        "LEADS": [f'"{place.at}") at="{place.at}" ;;' for place in places if len(place.words) > 1],
        "TAKES": [f"{' | '.join(options)}) {offered}; return ;;" for offered, options in takes.items()],
        "FLAGS": [f'"{place.at}") {offers(place.flags, files=False)} ;;' for place in places],
        "FOLLOWS": [f'"{place.at}") {offers(place.following, files=place.files)} ;;' for place in places],
    }
    for name, lines in cases.items():
        frame = frame.replace(f"{{{name}}}", "\n".join(f"      {line}" for line in lines))
    return frame


_BASH = """\
# canon's completion for bash; printed by: canon completion bash
_canon_files() {
  local IFS=$'\\n'
  compopt -o filenames 2>/dev/null
  COMPREPLY+=($(compgen -f -- "$1"))
}
_canon() {
  local current="${COMP_WORDS[COMP_CWORD]}" previous="${COMP_WORDS[COMP_CWORD-1]}" at="canon" i
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; i++)); do
    case "$at ${COMP_WORDS[i]}" in
{LEADS}
    esac
  done
  case "$at $previous" in
{TAKES}
  esac
  if [[ $current == -* ]]; then
    case "$at" in
{FLAGS}
    esac
  else
    case "$at" in
{FOLLOWS}
    esac
  fi
}
complete -F _canon canon
"""


def _bash_offers(words: Mapping[str, str], *, files: bool) -> str:
    listed = shlex.quote(" ".join(words))
    offered = [f'COMPREPLY=($(compgen -W {listed} -- "$current"))'] if words else []
    return "; ".join([*offered, *(['_canon_files "$current"'] if files else [])]) or ":"


_ZSH = """\
#compdef canon
# canon's completion for zsh; printed by: canon completion zsh
_canon() {
  local current="${words[CURRENT]}" previous="${words[CURRENT-1]}" at="canon"
  local -a offered
  integer i
  for ((i = 2; i < CURRENT; i++)); do
    case "$at ${words[i]}" in
{LEADS}
    esac
  done
  case "$at $previous" in
{TAKES}
  esac
  if [[ $current == -* ]]; then
    case "$at" in
{FLAGS}
    esac
  else
    case "$at" in
{FOLLOWS}
    esac
  fi
}
if [[ $funcstack[1] == _canon ]]; then _canon "$@"; else compdef _canon canon; fi
"""


def _zsh_offers(words: Mapping[str, str], *, files: bool) -> str:
    listed = " ".join(
        shlex.quote(f"{word}:{_line(about)}" if about else word) for word, about in words.items()
    )
    kind = "-o " if any(word.startswith("-") for word in words) else ""
    offered = [f"offered=({listed}); _describe {kind}canon offered"] if words else []
    return "; ".join([*offered, *(["_files"] if files else [])]) or ":"


def fish(places: Sequence[Place]) -> str:
    """Return a script for fish 3 or later."""
    return "\n".join(
        ["# canon's completion for fish; printed by: canon completion fish", *_fish_lines(places), ""]
    )


def _fish_lines(places: Sequence[Place]) -> Iterator[str]:
    yield "complete -c canon -f"
    for place in places:
        deeper = [p.words[-1] for p in places if p.words[:-1] == place.words]
        seen = [f"__fish_seen_subcommand_from {word}" for word in place.words[1:]]
        if deeper:
            seen.append(f"not __fish_seen_subcommand_from {' '.join(deeper)}")
        here = f"complete -c canon -n {_fish_quoted('; and '.join(seen))}"
        for word, about in place.following.items():
            yield f"{here} -a {_fish_quoted(word)}" + (f" -d {_fish_quoted(about)}" if about else "")
        if place.files:
            yield f"{here} -F"
        for option in place.options:
            names = " ".join(f"-l {n[2:]}" if n.startswith("--") else f"-s {n[1:]}" for n in option.names)
            takes = " -r -F" if option.files else " -x" if option.takes_value else ""
            values = f" -a {_fish_quoted(' '.join(option.values))}" if option.values else ""
            yield f"{here} {names}{takes}{values} -d {_fish_quoted(_line(option.about))}"


def _fish_quoted(text: str) -> str:
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"


def _line(about: str) -> str:
    return " ".join(about.replace("%%", "%").split())


SHELLS: dict[str, Callable[[Sequence[Place]], str]] = {"bash": bash, "zsh": zsh, "fish": fish}
