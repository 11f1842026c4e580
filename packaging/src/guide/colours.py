"""Colours code with Pygments: reads [[language, code], ...] as JSON, writes as many pieces of HTML."""

import json
import sys

from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import get_lexer_by_name

formatter = HtmlFormatter(nowrap=True)
json.dump(
    [highlight(code, get_lexer_by_name(language), formatter) for language, code in json.load(sys.stdin)], sys.stdout
)
