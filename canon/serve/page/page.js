// The page of `canon serve`: a form for each kind of claim, how each text is read while it is typed, the verdict.
// Everything that a person or the service says enters the page as text or as MathML elements, never as markup.

const READ_AFTER = 250; // milliseconds without a key before a text is read
const MATHML = "http://www.w3.org/1998/Math/MathML";
const ASSUMPTIONS = ["positive", "negative", "nonzero", "real", "integer"];
const LAYOUT = new Set(["accent", "columnalign", "display"]);
const STATUS = { holds: "It holds ✓", fails: "It fails ✗", undecided: "Undecided", invalid: "It can't be read" };

const HINTS = {
  names: "names, with commas between them",
  texts: "one in each line",
  expressions: "in each line  name = expression",
  lists: "in each line  name = expression; the lines of one name are its components",
  brackets: "in each line  f ; g ; value",
  words: "words, with commas between them",
  bodies: 'as JSON, such as [{"m": "m", "r": ["x", "0"]}]',
  forces: 'as JSON, such as [{"F": ["0", "-m*g"], "r": ["x", "y"]}]',
  values: 'as JSON, such as [{"a": "1/2"}]',
};
const READABLE = new Set(["text", "texts", "expressions", "lists", "brackets"]);
const DECLARATIONS = {
  parameters: ["parameters", "in each line names and what is assumed of them, such as  m, l, g positive"],
  functions: ["functions", "in each line an arbitrary function, such as  V(x)"],
  domain: ["domain", "in each line a condition that holds besides, such as  x < pi"],
};

const $ = (id) => document.getElementById(id);
let kinds = {};
let fields = new Map(); // key → {shape, control, reading, error, asked}

function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

const lines = (text) => text.split("\n").map((line) => line.trim()).filter(Boolean);
const words = (text) => text.split(/[\s,;]+/).filter(Boolean);

function split(line, what) {
  const at = line.indexOf("=");
  if (at < 1) throw new Error(`${what}: write  name = expression  in each line`);
  return [line.slice(0, at).trim(), line.slice(at + 1).trim()];
}

// What stands in a field, as a sheet has it under its key; undefined where nothing does.
function value(key, { shape, control }) {
  if (control.type === "checkbox") return control.checked || undefined;
  const text = control.value.trim();
  if (!text) return undefined;
  switch (shape) {
    case "names": return words(text);
    case "words": return text.split(",").map((word) => word.trim()).filter(Boolean);
    case "texts": return lines(text);
    case "number": return Number(text);
    case "expressions": return Object.fromEntries(lines(text).map((line) => split(line, key)));
    case "lists": {
      const found = {};
      for (const [name, item] of lines(text).map((line) => split(line, key))) (found[name] ??= []).push(item);
      return found;
    }
    case "brackets": {
      const [a, b] = $("kind").value === "lagrange-bracket" ? ["u", "v"] : ["f", "g"];
      return lines(text).map((line) => {
        const parts = line.split(";").map((part) => part.trim());
        if (parts.length !== 3) throw new Error(`${key}: write  ${a} ; ${b} ; value  in each line`);
        return { [a]: parts[0], [b]: parts[1], value: parts[2] };
      });
    }
    case "parameters": {
      const found = {};
      for (const line of lines(text)) {
        const said = words(line);
        const assumed = ASSUMPTIONS.includes(said.at(-1)) ? said.pop() : "real";
        for (const name of said) found[name] = assumed;
      }
      return found;
    }
    case "functions":
      return Object.fromEntries(lines(text).map((line) => {
        const match = /^(\w+)\s*\(([^)]*)\)$/.exec(line);
        if (!match) throw new Error(`${key}: write a function as  V(x)`);
        return [match[1], words(match[2])];
      }));
    case "bodies": case "forces": case "values": {
      try { return JSON.parse(text); } catch { throw new Error(`${key}: this is not JSON yet`); }
    }
    default: return text;
  }
}

// The text of a field for what a sheet has under its key.
function textOf(shape, said) {
  if (said === undefined) return "";
  switch (shape) {
    case "names": case "words": return [].concat(said).join(", ");
    case "texts": return [].concat(said).join("\n");
    case "expressions": return Object.entries(said).map(([name, text]) => `${name} = ${text}`).join("\n");
    case "lists": return Object.entries(said).flatMap(([name, texts]) => [].concat(texts).map((text) => `${name} = ${text}`)).join("\n");
    case "brackets": return said.map((pair) => Object.values(pair).join(" ; ")).join("\n");
    case "parameters": {
      const named = {};
      for (const [name, word] of Object.entries(said)) (named[word] ??= []).push(name);
      return Object.entries(named).map(([word, names]) => `${names.join(", ")} ${word}`).join("\n");
    }
    case "functions": return Object.entries(said).map(([name, of]) => `${name}(${of.join(", ")})`).join("\n");
    case "bodies": case "forces": case "values": return JSON.stringify(said);
    default: return String(said);
  }
}

function addField(place, key, shape, label, hint) {
  const id = `field-${key}`;
  const single = ["names", "word", "words", "number"].includes(shape);
  const check = shape === "true" || shape === "switch";
  const control = check ? element("input", { type: "checkbox", id })
    : single ? element("input", { type: "text", id, spellcheck: false })
    : element("textarea", { id, rows: 1, spellcheck: false });
  control.setAttribute("autocapitalize", "off");
  const error = element("p", { className: "error", id: `${id}-error` });
  error.setAttribute("aria-live", "polite");
  const reading = element("div", { className: "reading", id: `${id}-reading` });
  const row = element("div", { className: "row" });
  if (check) row.append(element("label", {}, control, label));
  else row.append(element("label", { htmlFor: id }, label));
  const described = [];
  if (hint && !check) {
    row.append(element("p", { className: "hint", id: `${id}-hint` }, hint));
    described.push(`${id}-hint`);
  }
  if (!check) row.append(control);
  if (READABLE.has(shape) || key === "domain") {
    row.append(reading);
    described.push(reading.id);
  }
  row.append(error);
  control.setAttribute("aria-describedby", [...described, error.id].join(" "));
  $(place).append(row);
  const field = { shape, control, reading, error, place, asked: null, timer: 0 };
  fields.set(key, field);
  control.addEventListener("input", () => {
    grow(control);
    if (place === "names" || ["parameters", "functions", "t"].includes(key)) for (const [other, one] of fields) readSoon(other, one);
    else readSoon(key, field);
  });
}

function grow(control) {
  if (control.tagName === "TEXTAREA") control.rows = Math.min(12, Math.max(1, control.value.split("\n").length));
}

function build() {
  const name = $("kind").value, kind = kinds[name];
  for (const place of ["names", "given", "answer", "more"]) $(place).querySelectorAll(".row").forEach((row) => row.remove());
  fields = new Map();
  const alternatives = new Set(kind.one_of.flat());
  const all = { ...kind.required, ...kind.optional };
  for (const [key, shape] of Object.entries(all)) {
    const needed = key in kind.required || alternatives.has(key);
    const place = kind.answer.includes(key) ? "answer" : shape === "names" ? "names" : needed ? "given" : "more";
    const label = key in kind.required ? key : `${key} (optional)`;
    addField(place, key, shape, alternatives.has(key) && !(key in kind.required) ? `${key} (one of several)` : label, HINTS[shape]);
  }
  for (const [key, [label, hint]] of Object.entries(DECLARATIONS)) {
    const [place, shape] = key === "domain" ? ["more", "texts"] : ["names", key];
    addField(place, key, shape, label, hint);
  }
  addField("more", "t", "word", "the name of the time", "t unless said");
  addField("more", "complete", "true", "the answer must determine everything that is asked");
  $("kind-note").textContent = `The answer determines ${kind.unknowns}.`;
  $("example").hidden = !kind.example;
}

function fill() {
  const said = kinds[$("kind").value].example;
  for (const [key, field] of fields) {
    if (field.control.type === "checkbox") field.control.checked = Boolean(said[key]);
    else field.control.value = textOf(field.shape, said[key]);
    grow(field.control);
  }
  for (const [key, field] of fields) readSoon(key, field);
}

function declared() {
  const found = {};
  for (const [key, field] of fields) {
    if (field.shape === "names" || ["parameters", "functions", "t"].includes(key)) {
      const said = value(key, field);
      if (said !== undefined && !kinds[$("kind").value].answer.includes(key)) found[key] = said;
    }
  }
  return found;
}

async function post(path, body, signal) {
  const headers = { "Content-Type": "application/json" };
  const response = await fetch(path, { method: "POST", headers, body: JSON.stringify(body), signal });
  const said = await response.json();
  if (!response.ok) throw new Error(said.detail ?? `the service answered ${response.status}`);
  return said;
}

function mathml(text) {
  const parsed = new DOMParser().parseFromString(text, "application/xml").documentElement;
  return copied(parsed);
}

function copied(node) {
  if (node.nodeType === Node.TEXT_NODE) return document.createTextNode(node.data);
  const made = document.createElementNS(MATHML, node.localName);
  for (const { name, value: said } of node.attributes) if (LAYOUT.has(name)) made.setAttribute(name, said);
  made.append(...[...node.childNodes].map(copied));
  return made;
}

function tell(field, message, caret = "") {
  field.error.replaceChildren(message, ...(caret ? [element("pre", {}, caret)] : []));
  field.control.setAttribute("aria-invalid", message ? "true" : "false");
}

function readSoon(key, field) {
  clearTimeout(field.timer);
  if (READABLE.has(field.shape)) field.timer = setTimeout(() => read(key, field), READ_AFTER);
}

async function read(key, field) {
  field.asked?.abort();
  const asked = (field.asked = new AbortController());
  try {
    const text = value(key, field);
    if (text === undefined) {
      field.reading.replaceChildren();
      tell(field, "");
      return;
    }
    const said = await post("read", { ...declared(), kind: $("kind").value, key, text }, asked.signal);
    if (asked.signal.aborted) return;
    if (said.read) {
      field.reading.replaceChildren(
        ...said.statements.map((one) => (one.mathml ? mathml(one.mathml) : element("code", {}, one.plain))),
        ...said.warnings.map((warning) => element("p", { className: "warning" }, warning)),
      );
      tell(field, "");
    } else {
      const { place, column, reason, caret } = said.error;
      const where = [place && place !== key ? place : "", column ? `column ${column}` : ""].filter(Boolean).join(", ");
      field.reading.replaceChildren();
      tell(field, where ? `${where}: ${reason}` : reason, caret);
    }
  } catch (error) {
    if (error.name !== "AbortError") tell(field, error.message);
  }
}

async function check(event) {
  event?.preventDefault();
  if ($("check").getAttribute("aria-disabled") === "true") return;
  const kind = $("kind").value, place = $("verdict");
  $("check").setAttribute("aria-disabled", "true");
  place.replaceChildren(element("p", { className: "note" }, "It is being judged …"));
  try {
    const claim = { id: "claim", kind };
    for (const [key, field] of fields) {
      const said = value(key, field);
      if (said !== undefined) claim[key] = said;
    }
    await show(await post("check", claim), place);
  } catch (error) {
    place.replaceChildren(element("p", { className: "error" }, error.message));
  } finally {
    $("check").removeAttribute("aria-disabled");
  }
}

async function show(judgement, place) {
  const shown = element("div", { className: judgement.status });
  shown.append(element("p", { className: "status" }, STATUS[judgement.status]));
  const told = judgement.status === "fails" ? judgement.feedback || `${judgement.question || "the claim"} is wrong` : judgement.known;
  if (told && judgement.status !== "holds") shown.append(element("p", { className: "told" }, told));
  const example = judgement.status === "fails" && judgement.counterexample;
  if (example) {
    const point = Object.entries(example.point).map(([name, at]) => `${name} = ${at}`).join(", ");
    shown.append(element("p", {}, `At ${point || "every point"}: ${example.left} against ${example.right}.`));
  }
  if (judgement.status === "fails" && judgement.corrected) shown.append(await corrected(judgement.corrected));
  for (const warning of judgement.warnings) shown.append(element("p", { className: "warning" }, warning));
  if (judgement.status === "holds") {
    const how = judgement.certificate ? ` (${judgement.certificate})` : "";
    shown.append(element("p", { className: "note" }, `Proved${how}, on the whole domain.`));
  }
  if (judgement.steps.length) {
    const steps = judgement.steps.map(([text, formula]) => element("li", {}, `${text} `, element("code", {}, formula)));
    const list = element("ol", {}, ...steps);
    shown.append(element("details", {}, element("summary", {}, "How it was judged"), list));
  }
  place.replaceChildren(shown);
}

async function corrected(text) {
  const place = element("div", { className: "corrected" }, element("p", {}, "Right would be:"));
  for (const part of text.split("; ")) {
    let set = element("code", {}, part);
    try {
      const said = await post("read", { ...declared(), kind: $("kind").value, text: part });
      if (said.read && said.statements.every((one) => one.mathml)) set = element("div", {}, ...said.statements.map((one) => mathml(one.mathml)));
    } catch { /* it is shown as text */ }
    place.append(set);
  }
  return place;
}

kinds = await (await fetch("kinds.json")).json();
$("kind").append(...Object.keys(kinds).map((name) => element("option", { value: name }, name)));
$("kind").addEventListener("change", build);
$("example").addEventListener("click", fill);
$("claim").addEventListener("submit", check);
$("claim").addEventListener("keydown", (event) => { if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) check(event); });
build();
