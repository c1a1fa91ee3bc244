"""Reference pages of the JSON contracts: contract/*.schema.json and contract/openapi.json."""
import json
from pathlib import Path

from markdown import code, key, prose, table


def resolve(schema: dict, root: dict) -> dict:
    """The schema with a `$ref` followed; what stands beside the reference wins."""
    reference = schema.get("$ref")
    if reference is None or not reference.startswith("#/"):
        return schema
    target = root
    for part in reference[2:].split("/"):
        target = target[part]
    return {**target, **{word: value for word, value in schema.items() if word != "$ref"}}


def type_of(schema: dict, root: dict) -> str:
    reference = schema.get("$ref", "")
    if "/definitions/" in reference:
        name = reference.split("/")[-1]
        return f"[{name}](#definition-{name.lower().replace('_', '-')})"
    if "const" in schema:
        return code(json.dumps(schema["const"]))
    if "enum" in schema:
        return " \\| ".join(code(json.dumps(value)) for value in schema["enum"])
    for choice in ("oneOf", "anyOf"):
        if choice in schema:
            return " or ".join(dict.fromkeys(type_of(item, root) for item in schema[choice]))
    kind = schema.get("type", "object" if "properties" in schema else "any")
    if kind == "array" and isinstance(schema.get("items"), dict):
        return f"array of {type_of(schema['items'], root)}"
    return " or ".join(kind) if isinstance(kind, list) else kind


def range_of(schema: dict) -> str:
    parts = [f"{sign} {schema[bound]}" for bound, sign in (
        ("exclusiveMinimum", "&gt;"), ("minimum", "≥"), ("exclusiveMaximum", "&lt;"), ("maximum", "≤"))
        if bound in schema]
    low, high = schema.get("minItems"), schema.get("maxItems")
    if low is not None or high is not None:
        parts.append(f"{low} items" if low == high else f"{low or 0} to {high if high is not None else 'any'} items")
    return ", ".join(parts)


def rows_of(schema: dict, root: dict, prefix: str = "", depth: int = 0) -> list[list[str]]:
    """A row for each property, nested objects and array items below their own key."""
    rows = []
    for name, value in schema.get("properties", {}).items():
        full = resolve(value, root)
        values = [type_of(value, root), range_of(full)]
        if name in schema.get("required", []):
            values.append("**required**")
        if "default" in full:
            values.append(f"default {code(json.dumps(full['default']))}")
        words = full.get("description", full.get("title", ""))
        examples = ", ".join(code(json.dumps(example)) for example in full.get("examples", []))
        meaning = prose(words) + (f" Example: {examples}" if examples else "")
        rows.append([key(prefix + name), "; ".join(part for part in values if part), meaning])
        if "$ref" in value or depth > 6:
            continue
        for branch in [full, *full.get("oneOf", []), *full.get("anyOf", [])]:
            items = branch.get("items")
            if isinstance(items, dict) and "$ref" not in items:
                for item in [items, *items.get("oneOf", []), *items.get("anyOf", [])]:
                    rows += rows_of(item, root, prefix + name + "[].", depth + 1)
            if "$ref" not in branch:
                rows += rows_of(branch, root, prefix + name + ".", depth + 1)
    return rows


def schema_page(file: Path) -> str:
    schema = json.loads(file.read_text(encoding="utf-8"))
    head = ["key", "value", "meaning"]
    name = file.name.removesuffix(".schema.json")
    out = [f"# Schema of the {name} file\n", f"Source: ``contract/{file.name}``.\n",
           prose(schema.get("description", "")) + "\n", table(head, rows_of(schema, schema))]
    definitions = schema.get("definitions", schema.get("$defs", {}))
    for name, value in definitions.items():
        out.append(f"## Definition {name}\n")
        out.append(prose(value.get("description", "")) + "\n")
        rows = rows_of({"properties": {name: {**value, "description": ""}}}, schema)
        out.append(table(head, rows))
    return "\n".join(out)


def openapi_page(file: Path) -> str:
    contract = json.loads(file.read_text(encoding="utf-8"))
    out = ["# HTTP API\n", "Source: ``contract/openapi.json``.\n",
           prose(contract["info"].get("description", "")) + "\n"]
    rows = []
    for path, verbs in contract["paths"].items():
        for verb, operation in verbs.items():
            if isinstance(operation, dict) and "responses" in operation:
                answers = ", ".join(code(status) for status in operation["responses"])
                rows.append([code(f"{verb.upper()} {path}"), prose(operation.get("summary", "")), answers])
    return "\n".join(out) + "\n" + table(["route", "what", "answers"], rows)


def write_schema_reference(contract: Path, folder: Path) -> list[str]:
    folder.mkdir(parents=True, exist_ok=True)
    pages = []
    for file in sorted(contract.glob("*.schema.json")):
        name = file.name.removesuffix(".schema.json")
        (folder / f"{name}-schema.md").write_text(schema_page(file), encoding="utf-8")
        pages.append(f"{name}-schema")
    (folder / "http-api.md").write_text(openapi_page(contract / "openapi.json"), encoding="utf-8")
    return [*pages, "http-api"]
