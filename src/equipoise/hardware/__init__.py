"""From springs on paper to springs one can buy, wind and mount."""

from .choose.choose import choose_parts
from .choose.chosen import Choice, Chosen
from .realise.bill import Bill, bill
from .realise.realisations import Options, Realisation, realisations
from .sizing.compression import CompressionSpring
from .sizing.extension import ExtensionSpring
from .sizing.limits import Limits
from .sizing.winding import Envelope, Need, Winding
from .sizing.wire import WIRES, Wire, wire
from .stock.part import Stock
from .stock.parts import read_catalogue, write_catalogue
from .stock.selection import Selection, choose

__all__ = [
    "WIRES",
    "Bill",
    "Choice",
    "Chosen",
    "CompressionSpring",
    "Envelope",
    "ExtensionSpring",
    "Limits",
    "Need",
    "Options",
    "Realisation",
    "Selection",
    "Stock",
    "Winding",
    "Wire",
    "bill",
    "choose",
    "choose_parts",
    "read_catalogue",
    "realisations",
    "wire",
    "write_catalogue",
]
