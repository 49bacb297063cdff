"""`DropSession`: a session that shows what is dropped on its page, or chosen by a name.

What a dropped file is decides `kinds.py`. A material or a volume takes the place of what is shown;
any other file, such as a light, is opened beside it.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.viewing import kinds
from brdfkit.viewing.application import Application, Message
from brdfkit.viewing.choosing import make_application
from brdfkit.viewing.empty import EmptyApplication, list_names
from brdfkit.viewing.materials.application import MaterialApplication
from brdfkit.viewing.materials.opening import open_material
from brdfkit.viewing.materials.warm_up import warm_up
from brdfkit.viewing.pictures import describe_error
from brdfkit.viewing.session import Session
from brdfkit.viewing.uploads import Upload
from brdfkit.viewing.volumes import opening as volumes

NAMES = 6  # that an error lists at most
MODEL = "ggx"  # shown where a light or a mesh is dropped on an empty page


class DropSession(Session):
    """One view, whose application is exchanged when a file is dropped on the page."""

    def __init__(self, application: Application) -> None:
        super().__init__(application)
        self.upload = Upload()
        if self.is_empty:
            self.tasks.append(warm_up())

    @property
    def is_empty(self) -> bool:
        """Whether nothing is shown yet."""
        return isinstance(self.application, EmptyApplication)

    def close(self) -> None:
        """End what goes on, and delete the files of the page, which is gone."""
        with self.lock:
            super().close()
            self.upload.clear()

    def _answer(self, message: dict[str, Any], data: bytes) -> list[Message]:
        kind = message.get("type")
        if kind == "upload":
            return self._take_piece(message, data)
        if kind == "raw":
            return self._open_raw(message)
        if kind == "load":
            return self._load(message.get("name"))
        return super()._answer(message, data)

    def _load(self, name: Any) -> list[Message]:
        """Show a material, a model or a volume of brdfkit's own by its name, which is no path."""
        if name not in list_names():
            raise BrdfkitError(f"{str(name)[:60]!r} is no name of the list; reload the page.")
        return self.exchange(make_application(name))

    def _take_piece(self, message: dict[str, Any], data: bytes) -> list[Message]:
        """Take a piece of a file, and open the files of a drop after their last piece."""
        upload = self.upload
        if not upload.add(message, data):
            return [({"type": "uploaded"}, [])]
        folder = str(upload.files[0].parent)
        try:
            with _collect_warnings() as notes:
                messages = self._open(list(upload.files))
            return _hide_folder(_join_notes(messages, notes), folder)
        except BrdfkitError as error:
            return _hide_folder([describe_error(error), self.describe_state()], folder)
        finally:
            if upload.raw is None:
                upload.clear()

    def _open(self, files: list[Path]) -> list[Message]:
        """Open the files of a drop: the material or the volume, and then the others one by one."""
        found = [(path, kinds.find_kind(path)) for path in files]
        if not any(kind for _, kind in found):
            raise kinds.unknown_file_error(files)
        messages = self._open_subject(found)
        for path, kind in found:
            if kind in (kinds.ENVIRONMENT, kinds.MESH) and self.is_empty:
                messages += self.exchange(make_application(MODEL))
            if kind not in (kinds.VOLUME, kinds.MATERIAL, kinds.UNKNOWN):
                try:
                    messages += self._open_beside(path, kind)
                except BrdfkitError as error:
                    if not messages:
                        raise
                    messages.append(describe_error(error))  # and what was opened before is shown
        return messages

    def _open_subject(self, found: list[tuple[Path, str]]) -> list[Message]:
        """Show the volume or the material of a drop, if there is one.

        Files of an unknown kind are left to the reader, which may need them, too.
        """
        voxels = [path for path, kind in found if kind == kinds.VOLUME]
        if voxels:
            chosen = volumes.choose_volume(voxels)
            if volumes.needs_header(chosen):
                self.upload.raw = chosen
                return [volumes.ask_for_header(chosen)]
            return self.exchange(volumes.open_volume(chosen, voxels))
        materials = [path for path, kind in found if kind == kinds.MATERIAL]
        if len(materials) > 1:
            raise _several_materials_error(materials, [path for path, _ in found])
        if materials:
            return self.exchange(open_material(self, materials[0]))
        return []

    def _open_beside(self, path: Path, kind: str) -> list[Message]:
        """Open a file that is neither a volume nor a measured material."""
        if kind == kinds.STATE:
            changes: Any = kinds.read_json(path)
            try:
                return self._set({"changes": changes, "moving": False})
            except BrdfkitError as error:
                raise BrdfkitError(
                    f"{path.name}: all its settings are left aside, because one is wrong: {error}"
                ) from None
        if kind == kinds.FIT and not isinstance(self.application, MaterialApplication):
            return self.exchange(open_material(self, path))
        return self.application.open_beside(self, kind, path)

    def _open_raw(self, message: dict[str, Any]) -> list[Message]:
        """Open the file of voxels that waits for its header, as the user typed it; None cancels."""
        upload = self.upload
        try:
            if upload.raw is None or message.get("size") is None:
                return []
            settings = volumes.read_header(message)
            with _collect_warnings() as notes:
                messages = self.exchange(volumes.open_volume(upload.raw, [upload.raw], **settings))
            return _join_notes(messages, notes)
        finally:
            upload.clear()


def _several_materials_error(materials: list[Path], files: list[Path]) -> BrdfkitError:
    """Return the error for a drop with several materials, which names all that is not used."""
    count = "two" if len(materials) == 2 else f"{len(materials)}"
    text = f"{_join_names(materials)} are {count} materials; drop one of them."
    others = len(files) > len(materials)
    return BrdfkitError(f"{text} None of {_join_names(files)} is used." if others else text)


def _join_names(files: list[Path]) -> str:
    """Return the names of several files, of many the first ones, as a part of a sentence."""
    names = [path.name for path in files]
    if len(names) > NAMES:
        names[NAMES - 1 :] = [f"{len(names) - NAMES + 1} more"]
    return ", ".join(names[:-1]) + f" and {names[-1]}"


@contextmanager
def _collect_warnings() -> Iterator[list[str]]:
    """Collect the warnings of the block as texts."""
    notes: list[str] = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        yield notes
        notes += [str(warning.message) for warning in caught]


def _join_notes(messages: list[Message], notes: list[str]) -> list[Message]:
    """Return messages with `notes` and those that are shown as an error as one, the last."""
    texts = [message["text"] for message, _ in messages if message["type"] == "error"]
    others = [pair for pair in messages if pair[0]["type"] != "error"]
    text = " ".join([*notes, *texts])
    return [*others, ({"type": "error", "text": text}, [])] if text else others


def _hide_folder(messages: list[Message], folder: str) -> list[Message]:
    """Return messages without the folder of the upload, which means nothing to the user."""

    def hide(text: str) -> str:
        return text.replace(f"{folder}{os.sep}", "").replace(folder, "the dropped files")

    return [
        (m | {"text": hide(m["text"])} if m["type"] == "error" else m, data) for m, data in messages
    ]
