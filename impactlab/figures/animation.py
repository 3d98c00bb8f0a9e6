"""Moving pictures of one impact: deflection, plastic zone and contact force."""

import base64
import html
import io
import json
import re
import shutil
import subprocess
from collections.abc import Callable, Iterator, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.transforms import ScaledTranslation
from numpy.typing import NDArray
from PIL import Image

from impactlab.figures import access, labels, scales, style
from impactlab.figures.labels import display
from impactlab.files import check_suffix, replaced
from impactlab.model.discretisation import Discretisation
from impactlab.model.impact import paper_impact
from impactlab.model.parameters import PARAMETERS, with_values
from impactlab.types import Floats
from impactlab.variables import FIELDS

SUFFIXES = (".mp4", ".gif", ".html")
"""Suffixes of the files of animations."""
RATE = 25
"""Frames per second."""
FILE = "animation.html"
"""Name of the animation among the figures of a study of one run."""
_FRAMES = 120  # of that one
SIZE, DPI = (7.2, 5.2), 100  # inches; an even number of pixels, which MP4 needs
_BALL = 9.0  # radius of the sphere in points: it is no part of the scales
_LEAST = 1e-5  # smallest strain with a colour
Update = Callable[[int], None]
Pixels = NDArray[np.uint8]
"""An image in RGB, (height, width, 3)."""


class Animation:
    """A moving picture of one impact, of 25 frames per second. Notebooks play it.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        Figure at its final layout.
    moving : sequence of matplotlib.artist.Artist
        Artists that differ from frame to frame.
    update : callable
        Function that moves them to the frame of a number.
    times : sequence of str
        Time of each frame, in words.

    Attributes
    ----------
    frames : int
        Number of frames.

    Examples
    --------
    >>> run = il.simulate(il.paper_impact("10 m/s"), il.Discretisation(nodes=41), duration="6 ms")
    >>> animation = il.plot.animate(run, frames=10)
    >>> animation.frames
    10
    """

    def __init__(
        self, figure: Figure, moving: Sequence[Any], update: Update, times: Sequence[str]
    ) -> None:
        """Take a figure and what moves in it."""
        self.frames, self._times = len(times), times
        self._figure, self._moving, self._update = figure, moving, update
        self._title = str(figure.get_suptitle())

    def save(self, path: str | Path) -> Path:
        """Write the animation.

        Parameters
        ----------
        path : str or pathlib.Path
            File to write: .gif, .mp4 (by ffmpeg, or ``pip install 'impactlab[video]'``), or .html,
            one page with all frames.

        Returns
        -------
        pathlib.Path
            The file.

        Raises
        ------
        ValueError
            If the file has another suffix.
        OSError
            If ffmpeg is not installed, or the file cannot be written.
        """
        path = Path(path)
        check_suffix("path", path, SUFFIXES)
        write = {".mp4": self._write_mp4, ".gif": self._write_gif, ".html": self._write_html}
        with replaced(path) as unfinished:
            write[path.suffix.lower()](unfinished)
        return path

    def _drawn(self) -> Iterator[Pixels]:
        """Yield the figure without what moves, then each frame."""
        with style.applied():
            canvas: Any = FigureCanvasAgg(self._figure)
            for artist in self._moving:
                artist.set_animated(True)
            canvas.draw()
            still = canvas.copy_from_bbox(self._figure.bbox)
            yield _pixels(canvas)
        for number in range(self.frames):
            with style.applied():
                canvas.restore_region(still)
                self._update(number)
                for artist in self._moving:
                    self._figure.draw_artist(artist)
                pixels = _pixels(canvas)
            yield pixels

    def _write_gif(self, path: Path) -> None:
        _, *frames = map(Image.fromarray, self._drawn())
        colours = frames[-1].quantize(128)
        first, *others = (
            frame.quantize(palette=colours, dither=Image.Dither.NONE) for frame in frames
        )
        options: dict[str, Any] = {"append_images": others, "duration": 1000 // RATE, "loop": 0}
        first.save(path, format="GIF", save_all=True, **options)

    def _write_mp4(self, path: Path) -> None:
        frames = self._drawn()
        height, width, _ = next(frames).shape
        size, rate = f"{width}x{height}", str(RATE)
        raw = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", size, "-r", rate, "-i", "-"]
        mp4 = ["-an", "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-f", "mp4", "-y"]
        command = [_ffmpeg(), "-loglevel", "error", *raw, *mp4, str(path)]
        with subprocess.Popen(command, stdin=subprocess.PIPE) as process:
            assert process.stdin is not None
            for frame in frames:
                process.stdin.write(frame.tobytes())
        if process.returncode:
            raise OSError(f"ffmpeg ended with code {process.returncode}")

    def _write_html(self, path: Path) -> None:
        path.write_text(self._page(), encoding="utf-8")

    def _page(self) -> str:
        """Return a page that needs no other file: what frames change, over the still figure."""
        still, *frames = self._drawn()
        texts = {
            "title": html.escape(self._title),
            "width": str(still.shape[1]),
            "height": str(still.shape[0]),
            "last": str(self.frames - 1),
            "rate": str(RATE),
            "times": json.dumps(list(self._times)),
            "still": _encoded(Image.fromarray(still).quantize()),
            "frames": json.dumps([_encoded(_change(still, frame)) for frame in frames]),
        }
        page = Path(__file__).with_name("animation.html").read_text("utf-8")
        return re.sub(r"{{ (\w+) }}", lambda match: texts[match[1]], page)

    def _repr_html_(self) -> str:
        width, height = (round(DPI * inches) for inches in self._figure.get_size_inches())
        look = f'width="{width + 20}" height="{height + 80}" style="border: 0"'
        return f'<iframe srcdoc="{html.escape(self._page())}" {look}></iframe>'


def _pixels(canvas: Any) -> Pixels:
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()


def _change(still: Pixels, frame: Pixels) -> Image.Image:
    """Return what a frame changes, transparent elsewhere."""
    shown = (frame != still).any(axis=2, keepdims=True)
    pixels = np.concatenate([frame * shown, 255 * shown.astype(np.uint8)], axis=2)
    return Image.fromarray(pixels).quantize(128, Image.Quantize.FASTOCTREE)


def _encoded(image: Image.Image) -> str:
    """Return an image as the text of a PNG file."""
    buffer = io.BytesIO()
    image.save(buffer, format="PNG", optimize=True)
    return base64.b64encode(buffer.getvalue()).decode("ascii")


def _ffmpeg() -> str:
    """Return the command ffmpeg. Raises OSError where there is none."""
    if command := shutil.which("ffmpeg"):
        return command
    if find_spec("imageio_ffmpeg") is None:
        raise OSError("MP4 needs ffmpeg: install it, or pip install 'impactlab[video]'")
    import imageio_ffmpeg

    return str(imageio_ffmpeg.get_ffmpeg_exe())


def with_fields(run: xr.Dataset, frames: int) -> xr.Dataset:
    """Return a run with its fields over time: as it is, or else solved once more.

    run: of impactlab.simulate, or one run of a study. Raises ValueError where its impact is not one
    of the beam models.
    """
    if FIELDS.keys() <= run.keys():
        return run
    if _has_several_strikes(run):
        raise ValueError("animate: several strikes have no fields over time: take strikes: 1")
    if several := [dim for dim in run.dims if dim not in access.SAMPLED]:
        names = ", ".join(map(str, several))
        raise ValueError(f"animate: there are several runs, on {names}: select one of them")
    if not {"velocity", "nodes", "duration"} <= run.coords.keys():
        raise ValueError("animate: expected an impact, with its parameters as coordinates")
    values = {name: run[name].item() for name in PARAMETERS if name in run.coords}
    from impactlab.simulate import run_dataset  # late: figures do without the compiler

    impact, grid = with_values(paper_impact(), Discretisation(), values)
    solved = run_dataset(impact, grid, duration=float(run["duration"]), frames=frames)
    if not np.isfinite(solved["deflection"]).all():
        raise ValueError("animate: the run diverged: take more nodes or a smaller courant")
    return solved


def _has_several_strikes(run: xr.Dataset) -> bool:
    return "strikes" in run.coords and bool((run["strikes"] > 1).any())


def of_study(runs: xr.Dataset) -> Animation | None:
    """Return the animation of a study of one run that stores profiles; None of others."""
    if "deflection" not in runs or access.count(runs) != 1 or access.further_models(runs):
        return None
    if _has_several_strikes(runs) or not np.isfinite(runs["deflection"]).all():  # diverged
        return None
    return animation(with_fields(runs.squeeze(access.design_dims(runs)), _FRAMES))


Part = tuple[list[Any], Update]
"""Artists of a panel, and what moves them to a frame."""


@style.paper
def animation(run: xr.Dataset) -> Animation:
    """Return the moving picture of a run with fields over time."""
    figure = Figure(figsize=SIZE, dpi=DPI, layout="constrained")
    beam, zone, contact = figure.subplots(3, 1, height_ratios=[1.25, 0.85, 1.0])
    zone.sharex(beam)
    return composed(figure, run, [_beam(beam, run), _zone(zone, run), force_panel(contact, run)])


def composed(figure: Figure, run: xr.Dataset, parts: Sequence[Part]) -> Animation:
    """Return the animation of a figure on `field_time`, under a title with a clock."""
    speed = labels.amount(run["velocity"], run["velocity"].item(), 3)
    figure.suptitle(f"Impact at {speed}", x=0.01, ha="left", fontsize=9)
    clock = figure.text(0.99, 0.985, "", ha="right", va="top", fontsize=9)
    time = display(run["field_time"])
    times = [f"{value:.3f} {time.symbol}" for value in time(run["field_time"])]
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # nothing jumps from frame to frame

    def update(frame: int) -> None:
        clock.set_text(times[frame])
        for _, move in parts:
            move(frame)

    moving = [artist for artists, _ in parts for artist in artists]
    return Animation(figure, [*moving, clock], update, times)


def _at_frames(run: xr.Dataset, name: str) -> Floats:
    """Return a history at the times of the fields, in SI units."""
    return np.asarray(np.interp(run["field_time"], run["time"], run[name]))


def _beam(ax: Axes, run: xr.Dataset) -> Part:
    place, depth = display(run["x"]), display(run["deflection_over_time"])
    x, shapes = place(run["x"]), depth(run["deflection_over_time"])
    sphere = depth(_at_frames(run, "sphere_displacement"))
    low, high = np.nanmin(shapes), np.nanmax(shapes)
    room = 0.1 * (high - low) or 1.0
    ax.set(xlim=(x[0], x[-1]), ylim=(high + room, min(low - room, -0.35 * high)))  # downwards
    ax.set_ylabel(labels.axis("deflection", depth.symbol))
    ax.set_title("Beam and sphere (not to scale)", loc="left")
    ax.tick_params(labelbottom=False)
    scales.linear(ax, "y", ticks=4)
    (line,) = ax.plot(x, shapes[0], color=style.COLOURS[0], linewidth=2.0, solid_capstyle="butt")
    share = run["strike_position"].item() if "strike_position" in run else 0.5
    ends = [np.asarray(run.get(f"support_{end}", "pinned")).item() for end in ("left", "right")]
    _supports(ax, x, ends, "pinned", "^")
    _supports(ax, x, ends, "elastic", "d")
    _supports(ax, x, ends, "roller", "o")
    above = ScaledTranslation(0.0, (_BALL + 1.5) / 72, ax.figure.dpi_scale_trans)
    (ball,) = ax.plot(
        [x[0] + share * (x[-1] - x[0])],
        sphere[:1],
        "o",
        markersize=2 * _BALL,
        color=style.COLOURS[1],
        transform=ax.transData + above,
    )
    _supports(ax, x, ends, "clamped", "s")

    def move(frame: int) -> None:
        line.set_ydata(shapes[frame])
        ball.set_ydata(sphere[frame : frame + 1])

    return [line, ball], move


def _supports(ax: Axes, x: Floats, ends: list[str], kind: str, marker: str) -> None:
    """Mark the ends of one kind; x: from the left one to the right one."""
    places = [place for place, end in zip(x[[0, -1]], ends, strict=True) if end == kind]
    if places:
        height = np.zeros(len(places))
        ax.plot(places, height, marker, color=style.MUTED, markersize=6, clip_on=False)


def _zone(ax: Axes, run: xr.Dataset) -> Part:
    strain = run["equivalent_plastic_strain_over_time"]
    place, depth, unit = display(run["x"]), display(run["z"]), display(strain)
    x, z, fields = place(run["x"]), depth(run["z"]), unit(strain)
    ax.set(xlabel=labels.axis("distance from the left end", place.symbol))
    ax.set_ylabel(labels.axis("below the axis", depth.symbol))
    ax.set_title("Equivalent plastic strain (PEEQ)", loc="left")
    ax.grid(visible=False)
    ax.set_facecolor("0.95")
    least, largest = float(unit(_LEAST)), float(np.nanmax(fields))
    edge = 0.5 * run["beam_depth"].item() * depth.scale
    norm = LogNorm(least, max(largest, 10 * least))
    mesh = ax.pcolormesh(
        x, z, np.ma.masked_less(fields[0].T, least), norm=norm, cmap="viridis", shading="nearest"
    )
    ax.set(xlim=(x[0], x[-1]), ylim=(edge, -edge))
    scales.linear(ax, "xy", ticks=4)
    if largest >= least:
        ax.figure.colorbar(mesh, ax=ax, label=labels.axis("PEEQ", unit.symbol), pad=0.01)
    else:
        style.remark(ax, "no plastic strain")

    def move(frame: int) -> None:
        mesh.set_array(np.ma.masked_less(fields[frame].T, least))

    return [mesh], move


def force_panel(ax: Axes, run: xr.Dataset) -> Part:
    """Draw the contact force over time, with a marker that moves."""
    time, unit = display(run["time"]), display(run["contact_force"])
    times, forces = time(run["field_time"]), unit(_at_frames(run, "contact_force"))
    ax.plot(time(run["time"]), unit(run["contact_force"]), color="0.6", linewidth=0.9)
    ax.set(xlabel=labels.axis("time since first touch", time.symbol))
    ax.set_ylabel(labels.axis("contact force", unit.symbol))
    ax.set(xlim=(0.0, times[-1]), ylim=(0.0, None))
    scales.linear(ax, "xy", ticks=4)
    guide = ax.axvline(0.0, linestyle="-", **style.GUIDE)
    (marker,) = ax.plot(times[:1], forces[:1], "o", color=style.COLOURS[1], clip_on=False)

    def move(frame: int) -> None:
        guide.set_xdata([times[frame]] * 2)
        marker.set_data(times[frame : frame + 1], forces[frame : frame + 1])

    return [guide, marker], move
