"""Films of pictures: resvg draws them, FFmpeg writes them. Both are packages of the extra `closecall[video]`."""

from __future__ import annotations

import io
import itertools
import tempfile
from pathlib import Path
from typing import cast

import av
import resvg_py
from av.video.frame import PictureType
from av.video.reformatter import ColorRange

CODECS = {
    # Without loss: flat colours and text need fewer bytes so than with it.
    "webp": ("libwebp_anim", "bgra", ColorRange.JPEG, {"lossless": "1"}, {"loop": "0"}),
    # What browsers, phones and office programs play.
    "mp4": ("libx264", "yuv420p", ColorRange.MPEG, {"crf": "18"}, {}),
}


def film(pictures: list[str], rate: int, file_format: str, font: bytes) -> bytes:
    """The file with these pictures, SVGs of equal size, each shown for 1 / rate s."""
    codec, pixels, colours, options, container = CODECS[file_format]
    file = io.BytesIO()
    with (
        tempfile.TemporaryDirectory() as folder,
        av.open(file, "w", format=file_format, container_options=container) as out,
    ):
        font_file = Path(folder) / "font.ttf"
        font_file.write_bytes(font)
        stream: av.VideoStream | None = None
        place = 0
        for picture, same in itertools.groupby(pictures):
            drawn = frame(picture, font_file)
            if stream is None:
                stream = cast(av.VideoStream, out.add_stream(codec, rate=rate, options=options))
                stream.width, stream.height, stream.pix_fmt = drawn.width, drawn.height, pixels
            for _ in same:
                shown = drawn.reformat(format=pixels, dst_color_range=colours)
                # A picture as it comes is a whole one; in a film most are changes of the one before.
                shown.pts, shown.pict_type = place, PictureType.NONE
                out.mux(stream.encode(shown))
                place += 1
        if stream is not None:
            out.mux(stream.encode())
    return file.getvalue()


def frame(picture: str, font: Path) -> av.VideoFrame:
    """A picture, drawn."""
    png = resvg_py.svg_to_bytes(
        svg_string=picture, skip_system_fonts=True, font_files=[str(font)], sans_serif_family="DejaVu Sans"
    )
    reader = av.CodecContext.create("png", "r")
    return reader.decode(av.Packet(bytes(png)))[0]
