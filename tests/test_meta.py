"""Rules of the house, checked on the source: data flows one way, imports are light, public names are documented."""

import ast
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

import spaceplane

SOURCE = Path(spaceplane.__file__).parent
MODULES = {
    ".".join(("spaceplane", *path.relative_to(SOURCE).with_suffix("").parts)).removesuffix(".__init__"): path
    for path in sorted(SOURCE.rglob("*.py"))
}
TREES = {name: ast.parse(path.read_text(encoding="utf-8")) for name, path in MODULES.items()}

# A stage knows only the ones before it. `environment` knows nobody but the constants and may be known by any.
ORDER = (
    "errors",
    "files",
    "kernelcache",
    "plain",
    "progress",
    "environment",
    "vehicle",
    "mesh",
    "flow",
    "aero",
    "dynamics",
    "qualities",
    "control",
    "decks",
    "analysis",
    "report",
    "pipeline",
    "study",
    "validation",
    "commands",
    "cli",
    "__main__",
)


def imported(name: str) -> Iterator[str]:
    """Modules of the package that a module imports, lazily or not, but for type checking only."""
    package = name if MODULES[name].name == "__init__.py" else name.rpartition(".")[0]
    ignored = {
        inner
        for node in ast.walk(TREES[name])
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)
        for inner in ast.walk(node)
    }
    for node in ast.walk(TREES[name]):
        if node in ignored:
            continue
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in MODULES)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                parents = package.split(".")[: len(package.split(".")) - node.level + 1]
                base = ".".join([*parents, base]).rstrip(".")
            for alias in node.names:
                whole = f"{base}.{alias.name}"
                if whole in MODULES:
                    yield whole
                elif base in MODULES:
                    yield base


def stage(name: str) -> str | None:
    parts = name.split(".")
    return parts[1] if len(parts) > 1 else None


def test_every_stage_has_its_place():
    unknown = {stage(name) for name in MODULES} - set(ORDER) - {None}
    assert not unknown, f"give these packages a place in ORDER: {unknown}"


def test_data_flows_one_way():
    wrong = [
        f"{name} imports {other}"
        for name in MODULES
        for other in imported(name)
        if stage(name) and stage(other) and ORDER.index(stage(other)) > ORDER.index(stage(name))
    ]
    assert not wrong, "\n".join(wrong)


def test_no_import_cycles():
    graph = {name: set(imported(name)) - {name, "spaceplane"} for name in MODULES}
    done: set[str] = set()

    def visit(name: str, trail: tuple[str, ...]) -> None:
        assert name not in trail, " -> ".join([*trail, name])
        if name not in done:
            for other in sorted(graph[name]):
                visit(other, (*trail, name))
            done.add(name)

    for name in graph:
        visit(name, ())


@pytest.mark.parametrize("module", ["spaceplane", "spaceplane.cli", "spaceplane.pipeline"])
def test_import_is_light(module):
    """Starting a command must not load the plotting and 3-D libraries."""
    if module not in MODULES:
        pytest.fail(f"{module} is missing")
    code = f"import sys, {module}; print(*sorted({{m.partition('.')[0] for m in sys.modules}}))"
    loaded = set(
        subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    )
    assert not loaded & {"vtk", "vtkmodules", "pyvista", "plotly", "matplotlib", "trimesh"}


def public_definitions() -> Iterator[tuple[str, ast.AST]]:
    """Public functions, classes and methods of every module, with a name to report."""
    for name, tree in TREES.items():
        for node in tree.body:
            if isinstance(node, (ast.FunctionDef, ast.ClassDef)) and not node.name.startswith("_"):
                yield f"{name}.{node.name}", node
                if isinstance(node, ast.ClassDef):
                    for inner in node.body:
                        if isinstance(inner, ast.FunctionDef) and not inner.name.startswith("_"):
                            yield f"{name}.{node.name}.{inner.name}", inner


def test_modules_and_public_names_are_documented():
    silent = [name for name, tree in TREES.items() if not ast.get_docstring(tree)]
    silent += [name for name, node in public_definitions() if not ast.get_docstring(node)]
    assert not silent, "\n".join(silent)


# A unit, or a word that says there is none.
UNITS = re.compile(
    r"\b(m|m2|m3|mm|m/s2?|rad|rad/s|deg|degrees?|per degree|s|seconds|kg|kg/m3|kg m2|Pa|K|J|N|W|Hz|1/s|1/rad|W/m2)\b"
    r"|\b(ratio|fraction|factor|coefficients?|Mach|numbers?|dimensionless|scaled|per cent|decades|units?|SI|0 to 1)\b"
)


def takes_quantities(node: ast.FunctionDef) -> bool:
    """Whether an argument is annotated as a floating-point number."""
    arguments = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
    return any(
        a.annotation is not None and re.fullmatch(r"float( \| None)?", ast.unparse(a.annotation)) for a in arguments
    )


def is_kernel(node: ast.FunctionDef) -> bool:
    return any(re.search(r"jit|device|compiled|kernel", ast.unparse(decorator)) for decorator in node.decorator_list)


def test_quantities_carry_units():
    """A public function that takes a float says in its docstring, or in the argument's name, in what unit."""
    named = re.compile(r"_(m|m2|rad|deg|s|kg|Pa|K|ms|kgm2|rads|seconds)$|mach|gamma|fraction|ratio|tolerance|cfl")
    wanting = []
    for name, node in public_definitions():
        formats = stage(name) == "report"  # prints numbers of any unit
        if isinstance(node, ast.FunctionDef) and takes_quantities(node) and not is_kernel(node) and not formats:
            text = ast.get_docstring(node) or ""
            floats = [
                a.arg
                for a in [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
                if a.annotation is not None and ast.unparse(a.annotation).startswith("float")
            ]
            if not UNITS.search(text) and not all(named.search(arg) for arg in floats):
                wanting.append(name)
    assert not wanting, "\n".join(wanting)


# Distribution name -> the module it brings, where they differ; netCDF4 is named as xarray's engine, not imported.
MODULE_OF = {"pyyaml": "yaml", "pillow": "PIL", "netcdf4": "netCDF4"}
BROUGHT = {"vtkmodules": "pyvista", "vtk": "pyvista", "markupsafe": "jinja2", "mpl_toolkits": "matplotlib"}


def test_dependencies_are_those_imported():
    """Every run-time dependency is used, and everything used is declared."""
    project = tomllib.loads((SOURCE.parents[1] / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    bare = lambda text: re.split(r"[<>=!~\[; ]", text, maxsplit=1)[0].lower()  # noqa: E731
    declared = {MODULE_OF.get(bare(text), bare(text)) for text in project["dependencies"]}
    optional = {"OCP", "control"}  # the `step` and `decks` extras
    used = {
        name.partition(".")[0]
        for tree in TREES.values()
        for node in ast.walk(tree)
        for name in (
            [alias.name for alias in node.names]
            if isinstance(node, ast.Import)
            else [node.module or ""]
            if isinstance(node, ast.ImportFrom) and not node.level
            else []
        )
    }
    used = {BROUGHT.get(name, name) for name in used} - set(sys.stdlib_module_names) - {"spaceplane", "__future__", ""}
    assert used - optional <= declared, f"not declared: {used - optional - declared}"
    assert declared - {"netCDF4"} <= used, f"declared but never imported: {declared - {'netCDF4'} - used}"


def test_shape_parameters_are_complete():
    """Every parameter has a unit in its name or none, limits around its default, a meaning and a source."""
    from spaceplane.vehicle.shape import PARAMETERS, THESIS_PARAMETERS

    assert len(THESIS_PARAMETERS) == 19
    for parameter in PARAMETERS:
        assert parameter.name.endswith({"m": "_m", "deg": "_deg", "1": ""}[parameter.unit]), parameter.name
        assert 0.0 < parameter.lower <= parameter.default <= parameter.upper, parameter.name
        assert parameter.description and parameter.source, parameter.name


def test_every_registered_scheme_is_tested_by_name():
    """A flux or limiter that can be chosen by name appears in a test of the flow package, or the test runs over all."""
    from spaceplane.flow.fluxes import FLUXES
    from spaceplane.flow.limiters import LIMITERS

    text = "".join(path.read_text(encoding="utf-8") for path in (Path(__file__).parent / "flow").glob("test_*.py"))
    for registry, names in (("FLUXES", FLUXES), ("LIMITERS", LIMITERS)):
        assert names, registry
        for name in names:
            assert registry in text or f'"{name}"' in text, f"{name} of {registry} is never tested"
