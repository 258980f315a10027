"""A tool that knows FMI 2 and FMI 3 for co-simulation, and nothing of what is in an FMU."""

import ctypes
import pathlib
import xml.etree.ElementTree as ElementTree
import zipfile
from ctypes import byref, c_bool, c_char_p, c_double, c_int, c_int64, c_size_t, c_uint32, c_void_p

OK, WARNING, DISCARD, ERROR, FATAL = range(5)


class FmiError(Exception):
    """A call that was not answered by OK."""

    def __init__(self, function, status, messages):
        super().__init__(f"{function}: {status}: {messages}")
        self.status = status


class Variable:
    """A variable of a description. Its attributes are those in the description; None: it has no such attribute."""

    def __init__(self, name, reference, kind, attributes=None):
        self.name = name
        self.reference = reference
        self.kind = kind  # Real, Integer, Boolean or String, whatever the version of FMI calls it
        self.attributes = attributes or {}

    def __getattr__(self, name):
        return self.attributes.get(name)


class Fmu:
    """An FMU, unpacked in `folder`."""

    KINDS = {"Float64": "Real", "Int64": "Integer", "Boolean": "Boolean", "String": "String"}

    def __init__(self, path, folder):
        self.folder = pathlib.Path(folder).resolve()
        with zipfile.ZipFile(path) as archive:
            archive.extractall(self.folder)
        self.description = ElementTree.parse(self.folder / "modelDescription.xml").getroot()
        self.version = int(self.description.get("fmiVersion")[0])
        self.token = self.description.get("guid" if self.version == 2 else "instantiationToken")
        self.interface = self.description.find("CoSimulation")
        self.identifier = self.interface.get("modelIdentifier")
        self.variables = {}
        for element in self.description.find("ModelVariables"):
            if self.version == 2:
                kind, attributes = element[0].tag, {**element.attrib, **element[0].attrib}
            else:
                kind, attributes = self.KINDS[element.tag], dict(element.attrib)
                if (start := element.find("Start")) is not None:
                    attributes["start"] = start.get("value")
            name, reference = attributes["name"], int(attributes["valueReference"])
            self.variables[name] = Variable(name, reference, kind, attributes)
        platform = "linux64" if self.version == 2 else "x86_64-linux"
        [binary] = [path for name in (platform, "aarch64-linux")
                    for path in self.folder.glob(f"binaries/{name}/{self.identifier}.so")]
        self.library = ctypes.CDLL(str(binary))

    def instance(self, *arguments, **options):
        return (Instance2 if self.version == 2 else Instance3)(self, *arguments, **options)


class Instance:
    """An instance, whose calls raise FmiError if the FMU does not answer OK."""

    LOGGER = None
    STATE = "FMUstate"

    def __init__(self, fmu, name="team", token=None, resources=None, logging=True, early_return=True):
        self.fmu = fmu
        self.early_return = early_return  # of FMI 3: whether a step may end before its time
        self.messages = []  # status, category, text
        self.component = None
        self.logger = self.LOGGER(self._log)
        self.time = 0.0
        self.component = self._instantiate(name, fmu.token if token is None else token, resources, logging)
        if not self.component:
            raise FmiError("instantiate", None, self.messages)

    def words(self):
        return self.messages[-1][2] if self.messages else ""

    def call(self, name, *arguments):
        function = getattr(self.fmu.library, f"fmi{self.fmu.version}{name}")
        status = function(c_void_p(self.component), *arguments)
        if status != OK:
            raise FmiError(name, status, self.messages[-1:])

    def free(self):
        if self.component:
            function = getattr(self.fmu.library, f"fmi{self.fmu.version}FreeInstance")
            function.restype = None
            function(c_void_p(self.component))
            self.component = None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.free()

    def references(self, names):
        return (c_uint32 * len(names))(*(self.fmu.variables[name].reference for name in names))

    def get(self, *names):
        """The values of variables of one type."""
        kind = self.fmu.variables[names[0]].kind
        function, ctype = self.TYPES[kind]
        values = (ctype * len(names))()
        self.call(f"Get{function}", self.references(names), c_size_t(len(names)), values, *self.count(names))
        return [value.decode() if kind == "String" else bool(value) if kind == "Boolean" else value for value in values]

    def set(self, values):
        """Sets variables of one type, by name."""
        names = list(values)
        kind = self.fmu.variables[names[0]].kind
        function, ctype = self.TYPES[kind]
        texts = [value.encode() if kind == "String" else value for value in values.values()]
        self.call(f"Set{function}", self.references(names), c_size_t(len(names)), (ctype * len(names))(*texts),
                  *self.count(names))

    def start(self, **values):
        """From its making to its first step, with values set."""
        for name, value in values.items():
            self.set({name: value})
        self.enter()
        self.call("ExitInitializationMode")

    def state(self):
        place = c_void_p()
        self.call(f"Get{self.STATE}", byref(place))
        return place, self.time

    def restore(self, state):
        self.call(f"Set{self.STATE}", state[0])
        self.time = state[1]

    def forget(self, state):
        self.call(f"Free{self.STATE}", byref(state[0]))

    def serialize(self, state):
        size = c_size_t()
        self.call(f"Serialized{self.STATE}Size", state[0], byref(size))
        data = (ctypes.c_ubyte * size.value)()
        self.call(f"Serialize{self.STATE}", state[0], data, size)
        return bytes(data)

    def deserialize(self, data, time=0.0):
        place = c_void_p()
        self.call(self.DESERIALIZE, (ctypes.c_ubyte * len(data))(*data), c_size_t(len(data)), byref(place))
        return place, time


class Callbacks(ctypes.Structure):
    LOGGER = ctypes.CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p)
    _fields_ = [("logger", LOGGER), ("allocate", c_void_p), ("free", c_void_p), ("finished", c_void_p),
                ("environment", c_void_p)]


class Instance2(Instance):
    LOGGER = Callbacks.LOGGER
    TYPES = {"Real": ("Real", c_double), "Integer": ("Integer", c_int), "Boolean": ("Boolean", c_int),
             "String": ("String", c_char_p)}
    DESERIALIZE = "DeSerializeFMUstate"

    def count(self, _):
        return ()

    def _log(self, _, name, status, category, message):
        self.messages.append((status, category.decode(), message.decode()))

    def _instantiate(self, name, token, resources, logging):
        self.callbacks = Callbacks(logger=self.logger)
        function = self.fmu.library.fmi2Instantiate
        function.restype = c_void_p
        location = (self.fmu.folder / "resources").as_uri() if resources is None else resources
        return function(name.encode(), c_int(1), token.encode(), location.encode(), byref(self.callbacks), c_int(0),
                        c_int(logging))

    def enter(self, start_s=0.0):
        self.call("SetupExperiment", c_int(0), c_double(0), c_double(start_s), c_int(0), c_double(0))
        self.call("EnterInitializationMode")
        self.time = start_s

    def step(self, step_s):
        """Returns whether the FMU wants the simulation to end."""
        try:
            self.call("DoStep", c_double(self.time), c_double(step_s), c_int(0))
        except FmiError as error:
            if error.status != DISCARD:
                raise
            ended, last_s = c_int(), c_double()
            self.call("GetBooleanStatus", c_int(3), byref(ended))
            self.call("GetRealStatus", c_int(2), byref(last_s))
            self.time = last_s.value
            return bool(ended.value)
        self.time += step_s
        return False


class Instance3(Instance):
    LOGGER = ctypes.CFUNCTYPE(None, c_void_p, c_int, c_char_p, c_char_p)
    TYPES = {"Real": ("Float64", c_double), "Integer": ("Int64", c_int64), "Boolean": ("Boolean", c_bool),
             "String": ("String", c_char_p)}
    STATE = "FMUState"
    DESERIALIZE = "DeserializeFMUState"

    def count(self, names):
        return (c_size_t(len(names)),)

    def _log(self, _, status, category, message):
        self.messages.append((status, category.decode(), message.decode()))

    def _instantiate(self, name, token, resources, logging):
        function = self.fmu.library.fmi3InstantiateCoSimulation
        function.restype = c_void_p
        location = f"{self.fmu.folder / 'resources'}/" if resources is None else resources
        return function(name.encode(), token.encode(), location.encode(), c_bool(False), c_bool(logging), c_bool(False),
                        c_bool(self.early_return), None, c_size_t(0), None, self.logger, None)

    def enter(self, start_s=0.0):
        self.call("EnterInitializationMode", c_bool(False), c_double(0), c_double(start_s), c_bool(False), c_double(0))
        self.time = start_s

    def step(self, step_s):
        event, ended, early, last_s = c_bool(), c_bool(), c_bool(), c_double()
        self.call("DoStep", c_double(self.time), c_double(step_s), c_bool(False), byref(event), byref(ended), byref(early),
                  byref(last_s))
        assert early.value or last_s.value == self.time + step_s, (early.value, last_s.value)
        self.time = last_s.value
        return ended.value
