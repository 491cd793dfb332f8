"""Checks the imports between the files of each crate and of the Python package: none runs up the list of layers, and no two
files import each other in a circle. Between crates, Cargo itself allows neither.

    python3 .ci/imports.py [ROOT]

In Rust an import is a `use` or a path through `crate::`, `super::` or a module of the file's own, outside of test modules. A name
that a module re-exports counts as an import of the file that defines it. `mod` declarations are not imports. Standard
library only; prints each fault with its file and exits with 1 if there is one.
"""

from __future__ import annotations

import ast
import re
import sys
from pathlib import Path

# From the ground up: a file may import what stands before it or beside it. Elsewhere only circles are looked for.
LAYERS = {
    "src": [["util"], ["error"], ["geometry"], ["braking"], ["options"], ["traffic"], ["detection"], ["events"], [""]],
    "crates/run/src": [["error"], ["util"], ["net", "options"], ["output"], ["run"], ["input"], [""]],
}
CRATES = ["src", "crates/run/src", "crates/analysis/src", "crates/study/src", "crates/cli/src", "bridge/src"]
PACKAGE = "bridge/python/closecall"

USE = re.compile(r"^\s*(pub(?:\([^)]*\))?\s+)?use\s+([^;]+);", re.MULTILINE)
PATH = re.compile(r"\b(?:crate|super|self|[a-z_][a-z0-9_]*)(?:::\w+)+\b(?!!)")
TEST_MODULE = re.compile(r"^#\[cfg\(test\)\]\nmod \w+ \{\n.*?^\}$", re.DOTALL | re.MULTILINE)
VISIBILITY = re.compile(r"\bpub\(in [^)]*\)")
STRING_OR_COMMENT = re.compile(r'"(?:[^"\\]|\\.)*"|//[^\n]*|/\*.*?\*/', re.DOTALL)

Tree = dict[str, Path]


def module_of(path: Path, source: Path) -> str:
    """The path of a file's module: "" for the crate's root."""
    parts = list(path.relative_to(source).with_suffix("").parts)
    if parts[-1] in ("mod", "lib"):
        parts.pop()
    return "::".join(parts)


def without_tests(text: str) -> str:
    """The text without its test module and comments, and with empty strings."""
    text = VISIBILITY.sub("pub", TEST_MODULE.sub("", text))
    return STRING_OR_COMMENT.sub(lambda found: '""' if found.group(0).startswith('"') else "", text)


def leaves(tree: str) -> list[str]:
    """The paths that a use tree names: `a::{b, c::d}` names `a::b` and `a::c::d`."""
    tree = re.sub(r"\s+", " ", tree).strip()
    if "{" not in tree:
        return [tree.split(" as ")[0].strip()]
    head, _, rest = tree.partition("{")
    found, depth, start, body = [], 0, 0, rest.rpartition("}")[0]
    for place, character in enumerate(body + ","):
        depth += {"{": 1, "}": -1}.get(character, 0)
        if character == "," and depth == 0:
            if part := body[start:place].strip():
                found += [head.strip() + leaf for leaf in leaves(part)]
            start = place + 1
    return found


class Crate:
    """The modules of a crate, and what each imports."""

    def __init__(self, source: Path) -> None:
        self.files: Tree = {module_of(path, source): path for path in sorted(source.rglob("*.rs"))}
        self.texts = {name: without_tests(path.read_text(encoding="utf-8")) for name, path in self.files.items()}
        self.exports = {name: self.exported(name) for name in self.files}

    def exported(self, module: str) -> dict[str, str]:
        """What a module re-exports, by name, with the full path of what that is."""
        found = {}
        for visible, tree in USE.findall(self.texts[module]):
            if visible:
                for leaf in leaves(tree):
                    if path := self.absolute(module, leaf):
                        found[leaf.rpartition("::")[2]] = path
        return found

    def absolute(self, module: str, path: str) -> str | None:
        """The path from the crate's root; none where it leads out of the crate."""
        first, *rest = path.split("::")
        base = module.split("::") if module else []
        if first == "crate":
            return "::".join(rest)
        if first == "self":
            return "::".join(base + rest)
        if first == "super":
            while [first, *rest][0] == "super":
                base, (first, *rest) = base[:-1], rest or [""]
            return "::".join([*base, first, *rest])
        inner = "::".join([*base, first])
        return "::".join([inner, *rest]) if inner in self.files else None

    def target(self, path: str, depth: int = 0) -> str | None:
        """The module that defines what a path names."""
        parts = path.split("::")
        for end in range(len(parts), -1, -1):
            name = "::".join(parts[:end])
            if name in self.files:
                item = parts[end] if end < len(parts) else None
                onward = self.exports[name].get(item) if item and hasattr(self, "exports") else None
                return self.target(onward, depth + 1) if onward and depth < 8 and onward != path else name
        return None

    def imports(self, module: str) -> set[str]:
        """The modules that a file imports."""
        text = self.texts[module]
        named = {leaf for _, tree in USE.findall(text) for leaf in leaves(tree)}
        used = {leaf.rpartition("::")[2]: leaf for leaf in named}
        for path in PATH.findall(USE.sub("", text)):
            first, _, rest = path.partition("::")
            named.add(f"{used[first]}::{rest}" if first in used else path)
        found = (self.absolute(module, path) for path in named)
        targets = {self.target(path) for path in found if path is not None}
        return {target for target in targets if target is not None} - {module}


def python_imports(package: Path) -> dict[str, set[str]]:
    """The modules of a Python package, with those that each imports; imports for types alone do not count."""
    found = {}
    for path in sorted(package.glob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        only_types = {
            inner
            for node in ast.walk(tree)
            if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test)
            for inner in ast.walk(node)
        }
        relative = [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.level]
        imported: set[str] = set()
        for node in relative:
            if node not in only_types:
                imported.update([node.module] if node.module else [name.name for name in node.names])
        found[path.stem] = imported
    return {module: targets & found.keys() - {module} for module, targets in found.items()}


def circles(edges: dict[str, set[str]]) -> list[list[str]]:
    """Groups of modules that import each other, directly or through others (Tarjan 1972)."""
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[list[str]] = []

    def visit(module: str) -> None:
        index[module] = low[module] = len(index)
        stack.append(module)
        for target in sorted(edges[module]):
            if target not in index:
                visit(target)
                low[module] = min(low[module], low[target])
            elif target in stack:
                low[module] = min(low[module], index[target])
        if low[module] == index[module]:
            place = stack.index(module)
            if len(group := stack[place:]) > 1:
                found.append(group)
            del stack[place:]

    for module in sorted(edges):
        if module not in index:
            visit(module)
    return found


def faults_of(crate: Crate, layers: list[list[str]], edges: dict[str, set[str]]) -> list[str]:
    """Modules without a layer, and imports that run up."""
    height = {name: height for height, names in enumerate(layers) for name in names}
    faults = []
    for module, targets in edges.items():
        own = height.get(module.partition("::")[0])
        if own is None:
            faults.append(f"{crate.files[module]}: no layer in .ci/imports.py")
            continue
        for target in sorted(targets):
            if height.get(target.partition("::")[0], 0) > own:
                faults.append(f"{crate.files[module]}: imports {target or 'the root'}, which stands above it")
    return faults


def main() -> int:
    root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent.parent
    graphs = {PACKAGE: python_imports(root / PACKAGE)}
    faults = []
    for folder in CRATES:
        crate = Crate(root / folder)
        graphs[folder] = {module: crate.imports(module) for module in crate.files}
        if folder in LAYERS:
            faults += faults_of(crate, LAYERS[folder], graphs[folder])
    for folder, edges in graphs.items():
        for group in circles(edges):
            names = ", ".join(f"{module} -> {', '.join(sorted(edges[module] & set(group)))}" for module in group)
            faults.append(f"{folder}: a circle of imports: {names}")
    files = sum(map(len, graphs.values()))
    print("\n".join(faults) if faults else f"{files} files: no import runs up, none in a circle")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
