"""API page: the OpenAPI document as a page for people, without scripts or anything fetched from elsewhere."""

from __future__ import annotations

import json
from typing import Any
from xml.etree.ElementTree import Element, SubElement, tostring

__all__ = ["api_page"]


def api_page(document: dict[str, Any]) -> str:
    """Return the page.

    Examples
    --------
    >>> page = api_page({"info": {"title": "<b>", "version": "1", "description": ""}, "paths": {}, "components": {}})
    >>> "&lt;b&gt;" in page, "<script" in page
    (True, False)
    """
    info = document["info"]
    root = Element("html", {"lang": "en"})
    head = SubElement(root, "head")
    SubElement(head, "meta", {"charset": "utf-8"})
    SubElement(head, "meta", {"name": "viewport", "content": "width=device-width, initial-scale=1"})
    _put(head, "title", f"{info['title']}: how programs ask")
    SubElement(head, "link", {"rel": "stylesheet", "href": "page.css"})
    SubElement(head, "link", {"rel": "icon", "href": "icon.svg"})
    main = SubElement(SubElement(root, "body"), "main")
    _put(main, "h1", f"{info['title']} {info['version']}: how programs ask")
    _put(main, "p", info["description"])
    line = _put(main, "p", "This page shows ")
    _put(line, "a", "openapi.json", href="openapi.json").tail = "; "
    _put(line, "a", "the page for people", href="./").tail = "."
    for path, methods in document["paths"].items():
        for method, said in methods.items():
            _operation(main, f"{method.upper()} {path}", said)
    schemas = document["components"].get("schemas", {})
    if schemas:
        _put(main, "h2", "What stands in them")
    for name, schema in schemas.items():
        _put(main, "h3", name)
        _put(main, "pre", json.dumps(schema, indent=2, ensure_ascii=False), tabindex="0")
    return f"<!DOCTYPE html>\n{tostring(root, encoding='unicode', method='html')}\n"


def _put(parent: Element, tag: str, text: str, **attributes: str) -> Element:
    element = SubElement(parent, tag, attributes)
    element.text = text
    return element


def _operation(main: Element, name: str, said: dict[str, Any]) -> None:
    _put(_put(main, "h2", ""), "code", name)
    _put(main, "p", said["summary"])
    if "description" in said:
        _put(main, "p", said["description"])
    example = said.get("requestBody", {}).get("content", {}).get("application/json", {}).get("example")
    if example is not None:
        _put(main, "p", "For example:")
        _put(main, "pre", json.dumps(example, indent=2, ensure_ascii=False), tabindex="0")
    answers = SubElement(main, "dl")
    for status, response in said["responses"].items():
        _put(answers, "dt", status)
        _put(answers, "dd", response["description"])
