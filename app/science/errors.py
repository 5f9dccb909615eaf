"""What the science raises. Delivery code maps these to problem+json or an exit status."""


class ScienceError(ValueError):
    """The input can't be worked with. The message says what is wrong, where, and what to do."""


class DecodeError(ScienceError):
    """A logger image holds nothing usable.

    Parameters
    ----------
    message : str
        What is wrong and what to do.
    offset : int
        Byte offset in the image at which it was noticed.
    """

    def __init__(self, message: str, offset: int) -> None:
        super().__init__(message)
        self.offset = offset


class VehicleConfigError(ScienceError):
    """A car's XML can't be used.

    Parameters
    ----------
    message : str
        What is wrong and what to do.
    line : int
        Line in the XML, 1-based; 0 when the text as a whole is meant.
    element : str
        Path of the element, for example ``ponthy_config/mass``.
    """

    def __init__(self, message: str, line: int = 0, element: str = "") -> None:
        super().__init__(message)
        self.line = line
        self.element = element


class SignalsError(ScienceError):
    """A signals table can't be used.

    Parameters
    ----------
    message : str
        What is wrong and what to do.
    row : int
        Row of the table, 1-based with the header as row 1; 0 when the table as a whole is meant.
    field : str
        Column or signal name.
    """

    def __init__(self, message: str, row: int = 0, field: str = "") -> None:
        super().__init__(message)
        self.row = row
        self.field = field


class TuningError(ScienceError):
    """A tuning file names an unknown entry or a value that can't be a covariance."""


class EstimatorDiverged(ScienceError):  # noqa: N818 - the name the design gives it
    """The filter's numbers stopped being finite.

    Parameters
    ----------
    message : str
        Which state failed and what to do.
    t_s : float
        Time in the recording at which it was noticed, seconds.
    """

    def __init__(self, message: str, t_s: float) -> None:
        super().__init__(message)
        self.t_s = t_s


class TooLittleData(ScienceError):  # noqa: N818 - reads as the condition it names
    """The recording is readable but lacks what the question needs."""
