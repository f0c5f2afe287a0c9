"""The topics of a running radar-chain in Python, over the package `iceoryx2` (0.10.0).

`Chain` enters the shared-memory domain of a chain as a process of its own name, `Chain.subscriber` and `Chain.publisher`
open a topic of its site. The layouts of headers and elements are in `messages.py`, which is written from the Rust types.
"""

import ctypes
import pathlib
import time

import iceoryx2 as iox2

from messages import STAGES, TOPICS

# What fails raises an exception; the rest of the log is about a chain that ended and cleaned up first.
iox2.set_log_level(iox2.LogLevel.Fatal)


class Chain:
    """A process at one site of a chain."""

    def __init__(self, process: str, site: str, prefix: str = "radar", root: str = "/tmp"):
        self.process, self.site = process, site
        folder = pathlib.Path(root).absolute() / f"radar-chain-{prefix}"
        if not (folder / "iceoryx2.toml").exists():
            raise SystemExit(f"no chain is running in the domain `{prefix}` ({folder})")
        config = iox2.config.from_file(iox2.FilePath.new(str(folder / "iceoryx2.toml")))
        self.node = (
            iox2.NodeBuilder.new()
            .name(iox2.NodeName.new(f"{process}@{site}"))
            .config(config)
            .signal_handling_mode(iox2.SignalHandlingMode.Disabled)
            .create(iox2.ServiceType.Ipc)
        )

    def _name(self, what: str):
        return iox2.ServiceName.new(f"radar/{self.site}/{what}")

    def _data(self, topic: str):
        of = TOPICS[topic]
        builder = self.node.service_builder(self._name(topic)).publish_subscribe(iox2.Slice[of.element])
        builder = builder.user_header(of.header)
        # The types by the names and alignments that they have in Rust: `ctypes` knows neither.
        describe = getattr(builder, "__payload_type_details")
        builder = describe(_type(of.element, of.element_name, iox2.TypeVariant.Dynamic, ctypes.alignment(of.element)))
        describe = getattr(builder, "__user_header_type_details")
        builder = describe(_type(of.header, of.header_name, iox2.TypeVariant.FixedSize, of.header_alignment))
        getattr(builder, "__set_payload_type")(iox2.Slice[of.element])
        getattr(builder, "__set_user_header_type")(of.header)
        return builder.open()

    def _event(self, what: str):
        return self.node.service_builder(self._name(what)).event().open()

    def subscriber(self, topic: str) -> "Subscriber":
        """A subscriber to a topic: an observer, for which no publisher waits."""
        service = self._data(topic)
        port = service.subscriber_builder().name(iox2.PortName.new(self.process)).create()
        return Subscriber(port, self._event(topic).listener_builder().create(), TOPICS[topic].element)

    def publisher(self, topic: str, most: int, consumers: list[str]) -> "Publisher":
        """The publisher of a topic, for messages of at most `most` elements, which waits for the stages `consumers`.

        In lossless mode the package has no way to tell an observer from a consumer when a queue is full: an observer that
        stands still blocks a publisher in Python (one in Rust goes on and counts).
        """
        ready = self._event(f"{topic}/ready").listener_builder().create()
        service = self._data(topic)
        port = service.publisher_builder().initial_max_slice_len(most).create()
        return Publisher(service, port, self._event(topic).notifier_builder().create(), ready, consumers)


def _type(of, name: str, variant, alignment: int):
    detail = iox2.TypeDetail.new().type_variant(variant).type_name(iox2.TypeName.new(name))
    return detail.size(ctypes.sizeof(of)).alignment(alignment)


class Subscriber:
    """Takes messages as they come and counts what is missing."""

    def __init__(self, port, listener, element):
        self._port, self._listener, self._element = port, listener, element
        self._last = None
        self.missed = 0

    def messages(self, seconds: float):
        """Headers with their elements as they arrive, until nothing has come for so long."""
        heard = time.monotonic()
        while time.monotonic() - heard < seconds:
            sample = self._port.receive()
            if sample is None:
                self._listener.timed_wait(iox2.Duration.from_millis(100))
                continue
            heard = time.monotonic()
            header = sample.user_header().contents
            if self._last is not None and header.seq > self._last + 1:
                self.missed += header.seq - self._last - 1
            self._last = header.seq
            payload = sample.payload()
            # The package gives the length of a type that was described to it in bytes.
            count = payload.len() // ctypes.sizeof(self._element)
            yield header, (self._element * count).from_address(payload.as_ptr())


class Publisher:
    """Publishes messages; not before its consumers are connected."""

    def __init__(self, service, port, arrival, ready, consumers):
        self._port, self._arrival = port, arrival
        arrival.notify()  # consumers look for a new publisher when they are woken
        awaited = {STAGES[name] for name in consumers}
        while awaited:
            for event in ready.timed_wait(iox2.Duration.from_millis(100)):
                awaited.discard(event.id.as_value)

    def publish(self, header, elements):
        """Sends a header with its elements and wakes the consumers."""
        sample = self._port.loan_slice_uninit(len(elements))
        payload = sample.payload()
        for place, element in enumerate(elements):
            payload[place] = element
        ctypes.memmove(sample.user_header_ptr, ctypes.byref(header), ctypes.sizeof(header))
        sample.assume_init().send()
        self._arrival.notify()
