"""Progress bars in a notebook: text on one line, for which no widgets are needed."""

import builtins

from impactlab.study.progress import items_done

ZMQInteractiveShell = type("ZMQInteractiveShell", (), {})  # as the shell of a notebook is named


def test_bars_are_drawn_in_notebooks_and_not_in_files(monkeypatch, capsys):
    with items_done(10, 0, "runs") as advance:
        advance(10, 0)
    assert capsys.readouterr() == ("", "")
    monkeypatch.setattr(builtins, "get_ipython", ZMQInteractiveShell, raising=False)
    with items_done(10, 4, "runs") as advance:
        advance(6, 2)
    drawn = capsys.readouterr()
    assert "10/10" in drawn.out
    assert "2 failed" in drawn.out
    assert drawn.out.count("\n") == 1
    assert drawn.err == ""
