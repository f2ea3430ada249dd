"""The examples in the docstrings of the package, in its stubs and in its README run."""

import ast
import doctest
import pathlib

import pytest

import isochore

PACKAGE = pathlib.Path(isochore.__file__).parent
README = pathlib.Path(__file__).resolve().parents[1] / "README.md"
DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef)


def examples():
    yield pytest.param(README.read_text(encoding="utf-8"), id="README")
    for path in [PACKAGE / "__init__.py", PACKAGE / "__init__.pyi"]:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            text = ast.get_docstring(node) if isinstance(node, DOCUMENTED) else None
            if text and ">>>" in text:
                yield pytest.param(text, id=f"{path.name}-{getattr(node, 'name', 'module')}")


@pytest.mark.parametrize("text", list(examples()))
def test_examples_run(text):
    example = doctest.DocTestParser().get_doctest(text, {}, "example", None, None)
    output = []
    result = doctest.DocTestRunner().run(example, out=output.append)
    assert result.attempted > 0 and result.failed == 0, "".join(output)
