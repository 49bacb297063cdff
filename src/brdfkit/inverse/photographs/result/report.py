"""The report of an `Svbrdf`: its maps, how certain they are, and photographs beside pictures of
them."""

import numpy as np

from brdfkit.core.pages import page
from brdfkit.core.pages.images import apply_colour_map, encode_jpeg, encode_png, shrink
from brdfkit.core.version import __version__
from brdfkit.inverse.photographs.capture.observations import gathered
from brdfkit.inverse.photographs.maps.residuals import MISFIT

WIDEST = 512  # pixels of a picture on the page
SCALE = "viridis"
OFF = "RdBu_r"
MOST_OFF = 0.2  # relative, the end of the scale of differences


def write_report(svbrdf, path):
    """Write the page of an `Svbrdf`."""
    document = svbrdf.document()
    table, *paragraphs = document.parts
    page.write_page(
        "svbrdf.html",
        path,
        title=document.title,
        columns=table.columns,
        rows=table.rows,
        said=[paragraph.text for paragraph in paragraphs],
        maps=[_shown_map(svbrdf, name) for name in svbrdf.maps],
        misfit=None if svbrdf.misfit is None else _scaled(svbrdf.misfit, 0, 2 * MISFIT),
        most=2 * MISFIT,
        photographs=[] if svbrdf.misfit is None else _photographs(svbrdf),
        version=__version__,
    )


def _shown_map(svbrdf, name):
    values, errors = svbrdf.maps[name], svbrdf.uncertainty.get(name)
    if name == "normal":
        picture, said = (
            encode_png(shrink((values + 1) / 2, WIDEST)),
            "x, y and z as red, green and blue",
        )
    elif values.ndim == 3:
        white = max(1e-6, float(np.quantile(values, 0.99)))
        picture, said = encode_jpeg(shrink(values / white, WIDEST)), f"white is {white:.3g}"
    else:
        low, high = np.quantile(values, (0.01, 0.99))
        picture, said = _scaled(values, low, high), f"{low:.3g} (dark) to {high:.3g} (bright)"
    return {"name": name, "said": said, "picture": picture, **_shown_errors(name, errors)}


def _shown_errors(name, errors):
    """The picture of a map's standard errors, if there are any, and what it shows."""
    if errors is None:
        return {"error": None}
    unit, errors = ("°", np.degrees(errors)) if name == "normal" else ("", errors)
    high = float(np.quantile(errors, 0.9))  # at the edge they are much larger
    said = f"standard error, 0 (dark) to {high:.2g}{unit} (bright)"
    return {"error": _scaled(errors, 0, high), "error_said": said}


def _photographs(svbrdf):
    """The photographs beside what the maps predict, the worst predicted first."""
    capture = svbrdf.capture
    seen, shown = (
        gathered(capture, pictures, svbrdf.shape)
        for pictures in (capture.pictures, svbrdf.rendered)
    )
    found = []
    for k in np.argsort([svbrdf.predicted[name] for name in capture.names]):
        photograph = seen[k].reshape(*svbrdf.shape, 3)
        prediction = shown[k].reshape(photograph.shape)
        white = max(1e-12, float(np.quantile(photograph, 0.99)))
        off = (prediction - photograph).mean(axis=2) / (photograph.mean(axis=2) + 0.05 * white)
        found.append(
            {
                "name": capture.names[k],
                "said": f"PSNR {svbrdf.predicted[capture.names[k]]:.1f} dB",
                "photograph": encode_jpeg(shrink(photograph / white, WIDEST)),
                "prediction": encode_jpeg(shrink(prediction / white, WIDEST)),
                "off": _scaled(off, -MOST_OFF, MOST_OFF, OFF),
            }
        )
    return found


def _scaled(values, low, high, scale=SCALE):
    shares = (shrink(values[..., None], WIDEST)[..., 0] - low) / max(high - low, 1e-12)
    return encode_png(apply_colour_map(scale, shares)[..., :3])
