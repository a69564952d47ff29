# Copyright 2026 fourbar_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Figures of matplotlib that a notebook shows by themselves, and that fit the column of a page."""
from io import StringIO
from textwrap import wrap
from typing import Any

from fourbar_lab.drawing.figure import CannotDraw
from fourbar_lab.drawing.labels import without_math
import matplotlib
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

MARGIN = 0.04        # [inch] left free on both sides of a figure of a given width


class PaperFigure(Figure):
    """
    A figure with the settings in which it was drawn.

    ``style``: of matplotlib; ``page_width``: of the picture [inch], 0: as wide as what is drawn,
    None: as the figure is.
    """

    style: dict[str, Any]
    page_width: float | None

    def title_of(self, text: str, title: str | None) -> str:
        """
        Return a title, or a text if there is none, in lines as wide as the figure.

        A title may hold formulas, a text has names that are written as they are.
        """
        letters = int(self.get_figwidth() * 72.0 / (0.6 * self.style['font.size']))
        return '\n'.join('\n'.join(wrap(line, letters))
                         for line in (without_math(text) if title is None else title).splitlines())

    def savefig(self, fname: Any, **options: Any) -> None:
        """Write it in its own settings, as wide as asked for; CannotDraw if it is wider."""
        with matplotlib.rc_context(self.style):
            box: Any = None if self.page_width is None else 'tight'
            if self.page_width:
                canvas = FigureCanvasAgg(self)
                self.draw_without_rendering()       # lays it out
                drawn = self.get_tightbbox(canvas.get_renderer())
                if drawn.width > self.page_width:
                    raise CannotDraw(f'the texts of this picture need {25.4 * drawn.width:.0f} mm,'
                                     f' and its width is {25.4 * self.page_width:.0f} mm')
                middle = 0.5 * (drawn.x0 + drawn.x1)
                box = Bbox([[middle - 0.5 * self.page_width, drawn.y0 - MARGIN],
                            [middle + 0.5 * self.page_width, drawn.y1 + MARGIN]])
            super().savefig(fname, **{'bbox_inches': box, **options})

    def _repr_svg_(self) -> str:
        file = StringIO()
        self.savefig(file, format='svg', metadata={'Date': None})
        _, _, text = file.getvalue().partition('<svg')      # without the head of an XML file
        return f'<svg style="max-width: 100%; height: auto"{text}'      # whole in a narrow page
