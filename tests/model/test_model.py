"""Models with values: they do not change, equal ones are equal, a pickle finds its class again."""

import pickle
import subprocess
import sys

import pytest

import brdfkit as bk
from brdfkit.model import labels

WARD = bk.models()["ward"]
FELT = """
from brdfkit.model import Model, shape, weight
from brdfkit.model.lobes import Cosine, Lobe

class Felt(Model):
    diffuse_reflectance = weight(0.3, "k_d")
    n = shape(1.0, (0.1, 4.0), "")

    def lobes(self):
        return (Lobe(lambda wi, wo: wo.z ** self.n, Cosine()),)
"""


@pytest.mark.parametrize(("name", "value"), [("alpha_u", -5), ("alpha_u", 0.1), ("colour", 1)])
def test_values_do_not_change(name, value):
    ward = WARD()
    with pytest.raises(
        bk.BrdfkitError, match=rf"values do not change; .*changed\({name}={value}\)"
    ):
        setattr(ward, name, value)
    assert ward == WARD()


def test_changed_values_are_those_of_another_model():
    ward = WARD(alpha_u=0.1, diffuse_reflectance=[0.1, 0.2, 0.3])
    other = ward.changed(alpha_u=0.3)
    assert (other.alpha_u, other.alpha_v) == (0.3, 0.3)  # what follows goes on to follow
    assert other.diffuse_reflectance == (0.1, 0.2, 0.3)
    assert WARD(alpha_u=0.1, alpha_v=0.2).changed(alpha_u=0.3).alpha_v == 0.2
    with pytest.raises(bk.BrdfkitError, match="alpha_u = -5"):
        ward.changed(alpha_u=-5)


@pytest.mark.parametrize(
    "make",
    [
        lambda: WARD(alpha_u=0.1),
        lambda: labels.model("koenderink:order=3")(a_0_0_0=0.7),
        lambda: labels.model("ggx+ward")(ggx_1_alpha_u=0.4),
    ],
)
def test_equal_models_are_equal(make):
    one, other = make(), make()
    assert one == other
    assert hash(one) == hash(other)
    assert pickle.loads(pickle.dumps(one)) == one
    name = one.shapes()[0] if one.shapes() else one.weights()[0]
    assert one != one.changed(**{name: getattr(one, name) * 0.9})
    assert one != bk.models()["lambert"]()
    assert one != "ward"


def test_equal_fits_are_equal():
    data = bk.load("plaster")
    one, other = (bk.fit(data, "ward", starts=2) for _ in range(2))
    assert one == other
    assert hash(one) == hash(other)
    assert pickle.loads(pickle.dumps(one)) == one
    assert one != bk.fit(data, "ward", starts=2, max_angle=60)


# A user's own, in another process


@pytest.fixture
def pickled(tmp_path, no_user_plugins):
    """A function: models of a user's file and a sum with it, pickled; the file's path."""
    file = tmp_path / "users_felt.py"
    file.write_text(FELT)
    bk.load_plugins(file)
    felt = labels.model("users_felt")(n=2.0)
    both = labels.model("ggx+users_felt")(users_felt_2_n=3.0)
    (tmp_path / "models.pkl").write_bytes(pickle.dumps([felt, both]))
    return file


READ = """
import pathlib, pickle, warnings
warnings.simplefilter("error")
try:
    felt, both = pickle.loads(pathlib.Path("models.pkl").read_bytes())
    print(felt.n, both.users_felt_2_n, felt.eval([[0, 0, 1]], [[0, 0.6, 0.8]])[0, 0].round(6))
except Exception as error:
    print(type(error).__name__, error)
"""


def read(folder, before=""):
    """What another process says of the pickle."""
    program = [sys.executable, "-c", before + READ]
    done = subprocess.run(program, cwd=folder, capture_output=True, text=True, timeout=300)
    return done.stdout + done.stderr


def test_a_pickle_finds_the_users_file(pickled):
    assert read(pickled.parent) == f"2.0 3.0 {0.3 * 0.8**2:.3f}\n"


def test_a_pickle_says_where_its_file_is_missing(pickled):
    moved = pickled.parent / "elsewhere"
    moved.mkdir()
    pickled.rename(moved / pickled.name)
    told = read(pickled.parent)
    assert told.startswith(f"BrdfkitError {pickled}: the file of the model 'users_felt' is missing")
    load = f"import brdfkit as bk; bk.load_plugins({str(moved / pickled.name)!r})\n"
    assert read(pickled.parent, load).startswith("2.0 3.0")


def test_a_pickle_says_that_its_file_has_changed(pickled):
    pickled.write_text(FELT + "\n# another version\n")
    assert read(pickled.parent).startswith(f"UserWarning {pickled} has changed since the model")
