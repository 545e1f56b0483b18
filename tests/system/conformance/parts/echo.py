"""FMU that passes on one value of every type, and one parameter of every type."""

from shipcosim.fmi import Fmu, Input, Output, Parameter


class Echo(Fmu):
    """Passes values on."""

    real = Input("m", "a number")
    whole = Input("1", "a whole number", start=0)
    flag = Input("1", "true or false", start=False)
    text = Input("1", "a text", start="")
    mode = Input("1", "a whole number that a case may call an enumeration", start=1)
    real_out = Output("m", "real")
    whole_out = Output("1", "whole", start=0)
    flag_out = Output("1", "flag", start=False)
    text_out = Output("1", "text", start="")
    size_out = Output("1", "length of text", start=0)
    mode_out = Output("1", "mode", start=1)
    real_set = Parameter(0.0, "m", "a number")
    whole_set = Parameter(0, "1", "a whole number")
    flag_set = Parameter(False, "1", "true or false")
    text_set = Parameter("", "1", "a text")
    mode_set = Parameter(1, "1", "a whole number that a case may call an enumeration")
    real_got = Output("m", "real_set")
    whole_got = Output("1", "whole_set", start=0)
    flag_got = Output("1", "flag_set", start=False)
    text_got = Output("1", "text_set", start="")
    size_got = Output("1", "length of text_set", start=0)
    mode_got = Output("1", "mode_set", start=1)

    def start(self):
        self.real_out, self.whole_out, self.flag_out = self.real, self.whole, self.flag
        self.text_out, self.mode_out = self.text, self.mode
        self.real_got, self.whole_got, self.flag_got = self.real_set, self.whole_set, self.flag_set
        self.text_got, self.mode_got = self.text_set, self.mode_set
        self.size_out, self.size_got = len(self.text), len(self.text_set)

    def step(self, t, h):
        self.start()
