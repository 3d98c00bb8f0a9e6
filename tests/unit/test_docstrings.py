"""Public docstrings as the site reads them: parameters with types, results and errors."""

import inspect
import re
from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest
from sphinx.ext.napoleon import Config, NumpyDocstring

import impactlab as il
from impactlab.validation.fields import Stated

RETURNED = {
    "Animation": "impactlab.figures.animation",
    "Estimate": "impactlab.study.estimate",
    "Problem": "impactlab.validation.errors",
    "Section": "impactlab.model.cross_section",
    "Status": "impactlab.study.inventory",
    "Surrogate": "impactlab.analysis.surrogate.stored",
}
"""Classes that public functions return, and their modules."""
FOREIGN = {"Any", "Axes", "DataFrame", "Dataset", "Floats", "None", "Path"}
"""Words of return annotations that are documented elsewhere."""
CONFIG = Config(napoleon_use_ivar=True)
FIELD = re.compile(r"^:(param|type|ivar|vartype|raises|returns) ?([^:]*):(.*)$", re.MULTILINE)


def _public():
    """Return every public class, function, method and property by name.

    Sections of a study are for their constructors: their methods serve the package.
    """
    things = {name: getattr(il, name) for name in dir(il)}
    things = {name: thing for name, thing in things.items() if not isinstance(thing, ModuleType)}
    things |= {name: getattr(import_module(module), name) for name, module in RETURNED.items()}
    for name, thing in list(things.items()):
        is_open = isinstance(thing, type) and not issubclass(thing, Stated)
        things |= dict(_methods(name, thing) if is_open else [])
    return things | {f"plot.{name}": getattr(il.plot, name) for name in il.plot.__all__}


def _methods(name, owner):
    for base in owner.__mro__:
        for member, value in vars(base).items():
            is_ours = base.__module__.startswith("impactlab") and not member.startswith("_")
            if is_ours and isinstance(value, property):
                yield f"{name}.{member}", value.fget
            elif is_ours and (inspect.isfunction(value) or isinstance(value, classmethod)):
                yield f"{name}.{member}", getattr(owner, member)


PUBLIC = _public()


def test_pages_that_sources_name_exist():
    root = Path(il.__file__).parents[1]
    named = {
        (path.relative_to(root).as_posix(), name)
        for path in root.glob("impactlab/**/*.py")
        for name in re.findall(r"[\w/]+\.md\b", path.read_text(encoding="utf-8"))
    }
    assert len(named) > 10
    assert {(path, name) for path, name in named if not (root / name).exists()} == set()


def _raises(thing):
    """Return whether the code of a function, or of the checks of a class, has a `raise`."""
    code = vars(thing).get("__post_init__") if isinstance(thing, type) else thing
    return bool(code and re.search(r"^ +raise ", inspect.getsource(code), re.MULTILINE))


def problems(thing):
    """Return the mismatches between a docstring and the signature of what it documents."""
    text = str(NumpyDocstring(inspect.getdoc(thing) or "", CONFIG))
    fields: dict[str, dict[str, str]] = {}
    for kind, names, description in FIELD.findall(text):
        for name in names.replace("\\", "").split(", "):
            fields.setdefault(kind, {})[name.lstrip("*")] = description.strip()
    attributes, types = fields.get("ivar", {}), fields.get("type", {}) | fields.get("vartype", {})
    documented = fields.get("param") or (attributes if isinstance(thing, type) else {})
    try:
        signature = inspect.signature(thing)
    except ValueError:  # of exceptions, which Python's own code makes
        arguments = [inspect.Parameter("args", inspect.Parameter.VAR_POSITIONAL)]
        signature = inspect.Signature(arguments if documented else [])
    parameters = {name: entry for name, entry in signature.parameters.items() if name != "self"}
    messages = [f"{name}: is not documented" for name in parameters.keys() - documented.keys()]
    messages += [f"{name}: is not a parameter" for name in documented.keys() - parameters.keys()]
    for name, description in (documented | attributes).items():
        messages += [f"{name}: has no description"] * (not description)
        messages += [f"{name}: has no type"] * (not types.get(name))
    for name in parameters.keys() & fields.get("param", {}).keys():
        has_default = bool(re.search("optional|default ", types.get(name, "")))
        if has_default != (parameters[name].default is not inspect.Parameter.empty):
            messages.append(f"{name}: has a default, or says so, but not both")
    returns = inspect.isfunction(thing) or inspect.ismethod(thing)
    if returns and ("returns" in fields) == (signature.return_annotation in ("None", None)):
        messages.append("Returns: is missing, or of nothing")
    unknown = [error for error in fields.get("raises", {}) if not error.isidentifier()]
    messages += [f"Raises: {error!r} is no error" for error in unknown]
    if (returns or isinstance(thing, type)) and _raises(thing) and "raises" not in fields:
        messages.append("Raises: is missing")
    return messages


@pytest.mark.parametrize("name", PUBLIC)
def test_docstrings_have_types_results_and_errors(name):
    assert problems(PUBLIC[name]) == []


def test_classes_that_functions_return_are_documented():
    annotations = [
        str(getattr(entry, "__annotations__", {}).get("return")) for entry in PUBLIC.values()
    ]
    words = {word for text in annotations for word in re.findall(r"\b[A-Z]\w+", text)}
    assert words - FOREIGN <= PUBLIC.keys()
    assert RETURNED.keys() <= words


def _without_type(length, width=1.0):
    """Return the area.

    Parameters
    ----------
    length
        Length, in m.
    depth : float
        Depth, in m.
    """
    if length < 0:
        raise ValueError("length: is negative")
    return length * width


def test_every_mismatch_is_a_problem():
    assert problems(_without_type) == [
        "width: is not documented",
        "depth: is not a parameter",
        "length: has no type",
        "Returns: is missing, or of nothing",
        "Raises: is missing",
    ]
