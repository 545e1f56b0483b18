"""Messages of FMUs of FMI 1.0 and 2.0 reach the instance that gave them.

These FMUs hand over a message as C formats one, with a variable number of arguments, which Python cannot read. FMPy
brings a function in C that formats it and passes it on, but to one function for the whole process. That function is
here, made once; it finds the instance by the environment that the FMU got, or by its name.
"""

from collections.abc import Callable
from ctypes import byref
from typing import Any
from weakref import WeakValueDictionary

_receivers: WeakValueDictionary[int, Any] = WeakValueDictionary()
_loggers: dict[Any, Any] = {}


def receive_messages(receiver: Any, callbacks: Any, logger_type: Callable[..., Any]) -> None:
    """Have an FMU's messages come to its slave.

    Parameters
    ----------
    receiver : LibrarySlave
        Its method ``log_message(status, text)`` gets them.
    callbacks : ctypes structure
        The callback functions that the FMU will be given.
    logger_type : ctypes function type
        Of the logger in this version of FMI.
    """
    from fmpy.logging import addLoggerProxy

    # Kept for good: an FMU may log at any time, and the function in C keeps the last one it was given.
    if logger_type not in _loggers:
        _loggers[logger_type] = logger_type(_pass_on)
    number = id(receiver)
    _receivers[number] = receiver
    callbacks.logger = _loggers[logger_type]
    if hasattr(callbacks, "componentEnvironment"):
        callbacks.componentEnvironment = number
    addLoggerProxy(byref(callbacks))


def _pass_on(environment, name, status, category, text):
    """Give a message to the instance with this environment, else to the newest of this name."""
    receiver = _receivers.get(environment or 0)
    if receiver is None:
        named = [
            receiver for receiver in list(_receivers.values()) if receiver.name.encode() == name
        ]
        receiver = named[-1] if named else None
    if receiver is not None:
        receiver.log_message(status, text)
