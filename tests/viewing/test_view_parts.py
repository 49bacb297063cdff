"""The camera, the transfer functions and the page of a view, against independent computations."""

import io

import numpy as np
import pytest
from PIL import Image

import brdfkit as bk
from brdfkit.viewing import front_end
from brdfkit.viewing.camera import Camera
from brdfkit.viewing.canvas_sizes import choose_size
from brdfkit.viewing.controls import Control
from brdfkit.viewing.encoding import to_bytes, to_bytes_quickly
from brdfkit.viewing.volumes import transfer_table
from brdfkit.viewing.volumes.histograms import make_histograms
from brdfkit.viewing.volumes.live_volume import LiveVolume
from brdfkit.volumes.transfer.files import list_presets


@pytest.mark.parametrize("size", [(64, 64), (96, 32), (32, 96)])
@pytest.mark.parametrize("elevation", [-90, 20, 90])
def test_the_camera_is_the_one_of_mitsuba(mi, size, elevation):
    """The ray through a place, and the place of a point, as Mitsuba's sensor has them."""
    camera, aspect = Camera(33.0, elevation, 5.0, 40.0, (1.0, 2.0, 3.0)), size[0] / size[1]
    film = {"type": "hdrfilm", "width": size[0], "height": size[1]}
    to_world = mi.ScalarTransform4f(camera.to_world)
    fov = camera.horizontal_fov(aspect)
    sensor = {"type": "perspective", "fov": fov, "to_world": to_world, "film": film}
    ray, _ = mi.load_dict(sensor).sample_ray(0, 0, mi.Point2f(0.2, 0.7), mi.Point2f(0.5))
    origin, direction = camera.cast_ray(0.2, 0.7, aspect)
    assert np.array(ray.d)[:, 0] == pytest.approx(direction, abs=1e-5)
    point = origin + 7 * direction
    assert camera.project(point[None], aspect)[0, :2] == pytest.approx([0.2, 0.7], abs=1e-6)


@pytest.mark.quick
def test_bumps_lie_over_each_other():
    bumps = [
        {"x": 0.4, "y": 0.5, "sx": 0.2, "sy": 0.3, "colour": "#ff0000", "a": 0.6},
        {"x": 0.6, "y": 0.2, "sx": 0.1, "sy": 0.4, "colour": "#00ff00", "a": 0.9},
    ]
    volume = LiveVolume(bk.volumes.Volume(np.arange(27.0).reshape(3, 3, 3)))
    table = transfer_table.table_of_bumps(bumps, volume, by_gradients=True)
    rows, columns = table.shape[:2]
    for row, column in ((0, 0), (20, 2000), (40, 2500)):
        x, y = column / (columns - 1), row / (rows - 1)
        colour, left = np.zeros(3), 1.0
        for bump in bumps[::-1]:  # from the top
            at = ((x - bump["x"]) / bump["sx"]) ** 2 + ((y - bump["y"]) / bump["sy"]) ** 2
            a = bump["a"] * np.exp(-at)
            colour += left * a * transfer_table.parse_colour(bump["colour"])
            left *= 1 - a
        assert table[row, column, 3] == pytest.approx(1 - left, abs=1e-12)
        assert table[row, column, :3] * (1 - left) == pytest.approx(colour, abs=1e-9)


@pytest.mark.quick
@pytest.mark.parametrize("name", list_presets())
def test_points_are_the_preset(name):
    function = bk.volumes.TransferFunction.load(name)
    volume = LiveVolume(bk.volumes.Volume(np.linspace(*function.range, 27).reshape(3, 3, 3)))
    values = np.linspace(*function.range, len(volume.row_values))
    points = transfer_table.to_points(function, *function.range)
    assert transfer_table.is_points(points)
    whole = transfer_table.table_of_function(function, volume)
    if function.gradients is None:
        table = transfer_table.table_of_points(points, values)
        assert np.abs(table - function(values)).max() < 0.02
        assert (whole == function(values)).all()
    else:  # a row for each of 64 gradient magnitudes
        row = function(values, np.full_like(values, volume.steepest * 20 / 63))
        assert whole[20] == pytest.approx(row, abs=1e-12)


@pytest.mark.quick
@pytest.mark.parametrize(("highest", "bins"), [(3, 4), (299, 300), (1499, 750)])
def test_bins_of_whole_numbers_hold_as_many_of_them(highest, bins):
    """Of 300 values, 24 bins of the joint histogram, and 212 others, had two values each."""
    values = np.arange(4 * 3 * (highest + 1)).reshape(4, 3, -1) % (highest + 1)
    volume = bk.volumes.Volume(values.astype(np.int16))
    counts, joint = make_histograms(volume, (0, highest), 1.0)
    assert counts == [values.size // bins] * bins
    width = Image.open(io.BytesIO(joint)).width
    assert (highest + 1) % width == 0


@pytest.mark.quick
@pytest.mark.parametrize(
    ("canvas", "size"),
    [
        ((64, 64), (64, 64)),
        ((1, 1), (64, 64)),
        ((544, 480), (576, 512)),  # and not 512 × 512, of which a tenth would be cropped
        ((868, 689), (896, 704)),
        ((3840, 2160), (2048, 1152)),
        ((10**400, 1), (64, 64)),
    ],
)
def test_a_picture_has_nearly_the_proportions_of_its_canvas(canvas, size):
    assert choose_size(*canvas) == size


@pytest.mark.quick
def test_a_slider_keeps_numbers_within_its_ends():
    slider = Control("n", "N", "p", 1, low=1, high=8, step=1)
    assert [slider.check(x) for x in (0, 2.4, 99)] == [1, 2, 8]


@pytest.mark.quick
def test_the_page_loads_nothing_from_elsewhere_and_evaluates_nothing():
    files = [front_end.read_page_file(n) for n in ("page.html", "page.js", "viewer.css")]
    for text in (front_end.read_module(), *files):
        assert "http://" not in text
        assert "https://" not in text
        assert "eval(" not in text
    assert "export default { render };" in front_end.read_module()


@pytest.mark.quick
def test_bytes_that_are_made_quickly_are_at_most_one_level_off():
    linear = np.linspace(0, 1, 20001)
    exact, quick = to_bytes(linear).astype(int), to_bytes_quickly(linear)
    assert abs(quick - exact).max() <= 1
    assert to_bytes_quickly(np.array([np.nan]))[0] == 0
