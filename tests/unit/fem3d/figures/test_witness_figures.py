"""The figures of a 3-D run show its mesh and its numbers."""

import json

import numpy as np
import pytest
from made_solid import DEPTH_OF_STRAIN, beam_models, solid
from matplotlib.collections import PolyCollection

from impactlab.fem3d.figures.run import draw_witness, faces, histories, mesh, plastic_strain
from impactlab.figures.data import alt


def area(polygons):
    """Shoelace, whichever way round."""
    x, y = polygons[..., 0], polygons[..., 1]
    ahead = np.roll(np.arange(4), -1)
    return abs(0.5 * np.sum(x * y[:, ahead] - x[:, ahead] * y, axis=1))


def test_faces_fill_the_planes_of_beam_and_sphere():
    given = solid()
    polygons, elements = faces(given, 1)
    of_beam = given["body"].values[elements] == 0
    assert area(polygons[of_beam]).sum() == pytest.approx(390.0 * 27.8)
    half_disc = 0.5 * np.pi * 35.0**2
    assert area(polygons[~of_beam]).sum() == pytest.approx(half_disc, rel=0.01)
    top, elements = faces(given, 2)
    assert area(top[given["body"].values[elements] == 0]).sum() == pytest.approx(390.0 * 30.0)
    # the mesh is seen whole and at the contact
    figure = mesh.plot(solid(), beam_models())
    above, side, top = figure.axes
    assert above.get_xlim()[1] > 390.0
    assert side.get_xlim() == (0.0, 18.0)  # three times the matched patch
    assert len(above.collections[0].get_paths()) == len(faces(solid(), 1)[0])
    assert len(top.collections[0].get_paths()) < len(faces(solid(), 2)[0]) + 1
    assert "beam" in [text.get_text() for text in figure.legends[0].get_texts()]
    assert "10,134 hexahedra, 2 mm about the contact" in mesh.caption(solid(), beam_models())


def test_plastic_elements_have_their_strain_in_per_cent():
    given = solid()
    ax = plastic_strain.plot(given, beam_models()).axes[0]
    still, plastic = (cells for cells in ax.collections if type(cells) is PolyCollection)
    _, elements = faces(given, 1)
    strain = given["equivalent_plastic_strain"].values[elements]
    assert plastic.get_array().tolist() == (100.0 * strain[strain >= 1e-5]).tolist()
    assert len(still.get_paths()) == int((strain < 1e-5).sum())
    reach = max(patch.vertices[:, 0].max() for patch in plastic.get_paths())
    said = plastic_strain.caption(given, beam_models())
    assert f"reaches {reach:g} mm from the impact" in said
    assert reach < 1e3 * DEPTH_OF_STRAIN + 2.0
    # a run without plastic strain says so
    elastic = solid().assign(equivalent_plastic_strain=0.0 * solid()["equivalent_plastic_strain"])
    figure = plastic_strain.plot(elastic, beam_models())
    assert [text.get_text() for text in figure.axes[0].texts] == ["no plastic strain"]
    assert "There is none." in plastic_strain.caption(elastic, beam_models())
    # alternative texts count cells and place the largest strain
    said = alt(plastic_strain.plot(solid(), beam_models()))
    assert "coloured cell" in said
    assert "the largest value at 1, −1" in said
    assert "Top of the beam: " in alt(mesh.plot(solid(), beam_models()))


def test_histories_are_the_stored_values_in_the_axes_units():
    given, others = solid(), beam_models()
    figure = histories.plot(given, others)
    force, deflection, _ = figure.axes
    assert force.get_ylabel() == "Contact force (kN)"
    assert deflection.get_ylabel() == "Deflection under the sphere (µm)"
    drawn = {line.get_label(): line for line in force.lines}
    assert list(drawn) == ["3-D", "Euler-Bernoulli", "Timoshenko", "Spring-Mass"]
    assert np.asarray(drawn["3-D"].get_ydata()) == pytest.approx(1e-3 * given["contact_force"])
    expected = 1e-3 * others["contact_force"].sel(beam_model="timoshenko")
    assert np.asarray(drawn["Timoshenko"].get_ydata()) == pytest.approx(expected)
    looks = [(line.get_color(), str(line.get_linestyle())) for line in drawn.values()]
    assert len(set(looks)) == 4


def test_every_figure_lands_with_caption_and_alternative_text(tmp_path):
    draw_witness(solid(), beam_models(), tmp_path, "paper")
    captions = json.loads((tmp_path / "captions.json").read_text())
    assert list(captions) == ["histories", "plastic_strain", "mesh"]
    for name, entry in captions.items():
        assert (tmp_path / f"{name}.svg").stat().st_size > 10_000
        assert (tmp_path / f"{name}.png").exists()
        assert entry["caption"]
        assert entry["alt"]
    assert (tmp_path / "histories.csv").exists()
