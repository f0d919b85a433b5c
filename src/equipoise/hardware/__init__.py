"""From springs on paper to springs one can buy, wind and mount."""

from .bill import Bill, bill
from .choice import Choice, choose
from .compression import CompressionSpring
from .extension import ExtensionSpring
from .limits import Limits
from .realise import Options, Realisation, realisations
from .stock import Stock, read_catalogue, write_catalogue
from .winding import Envelope, Need, Winding
from .wire import WIRES, Wire, wire

__all__ = [
    "WIRES",
    "Bill",
    "Choice",
    "CompressionSpring",
    "Envelope",
    "ExtensionSpring",
    "Limits",
    "Need",
    "Options",
    "Realisation",
    "Stock",
    "Winding",
    "Wire",
    "bill",
    "choose",
    "read_catalogue",
    "realisations",
    "wire",
    "write_catalogue",
]
