"""viewers_test.py HOST_COUNTING_ROBOT: documents, operations, the lease, STOP and telemetry, with several viewers."""

import time

import web_client
from served_page import run_tests
from web_client import Viewer, live, request

EVERYTHING = ["angle", "contact", "count"]


def test_a_viewer_gets_every_document_and_its_changes(server):
    with server.viewer("desk") as viewer:
        assert viewer.welcome == {"type": "welcome", "protocol": 1, "client": 1, "program": "counting robot 1",
                                  "next_notice": viewer.welcome["next_notice"]}
        viewer.until(lambda: {"session", "telemetry", "control"} <= viewer.documents.keys())
        revision = viewer.documents["session"]["revision"]
        assert viewer.control() == {"epoch": 0, "holder": None, "away": False, "request": None}
        epoch = viewer.take_control()
        assert viewer.do("add", epoch, by=7) == {"type": "result", "id": 2, "ok": True, "value": {"count": 7}}
        viewer.until(lambda: viewer.documents["session"]["value"]["count"] == 7)
        assert viewer.documents["session"]["revision"] > revision


def test_operations_need_control(server):
    with server.viewer("first") as first, server.viewer("second") as second:
        assert first.do("add", 0)["error"] == "nobody has control: take it first"
        epoch = first.take_control()
        assert second.do("add", epoch)["error"] == "control is with first"
        assert first.do("add", epoch + 1)["error"] == f"found epoch {epoch + 1} of control, expected {epoch}"
        assert first.do("add", epoch)["ok"]
        assert second.do("value")["value"] == {"count": 1}, "the refused operations had no effect"
        assert first.do("walk", epoch)["error"] == "found operation 'walk', expected one of this robot"


def test_a_viewer_that_connects_alone_has_control_if_it_wants_it_and_no_other_computer_can_connect(server):
    is_for_network = web_client.TLS is not None
    with server.viewer("script"):
        with server.viewer("second", wants_control=True) as second:
            second.until(lambda: "control" in second.documents)
            assert second.control()["holder"] is None, "another viewer is connected"
    for _ in range(2):  # the second one as after a reload
        with server.viewer("page", wants_control=True) as page:
            page.until(lambda: "control" in page.documents)
            holder = page.control()["holder"]
            assert holder is None if is_for_network else holder["name"] == "page", holder
            if not is_for_network:
                assert page.do("add", page.control()["epoch"])["ok"]


def test_control_passes_from_one_viewer_to_another(server):
    with server.viewer("first") as first, server.viewer("second") as second:
        old = first.take_control()
        live(first)  # who says nothing for a second is away, and loses control without a request
        asked = second.start("control.take")
        first.until(lambda: first.control()["request"] is not None)
        assert first.control()["request"]["name"] == "second" and first.control()["request"]["ms"] <= 10000
        first.do("control.answer", old, grant=False)
        assert second.result(asked)["error"] == "first keeps control"
        asked = second.start("control.take")
        first.until(lambda: first.control()["request"] is not None)
        assert first.do("control.answer", old, grant=True)["ok"]
        new = second.result(asked)["value"]["epoch"]
        assert new > old
        assert first.do("add", old)["error"] == "control is with second"
        assert second.do("add", new)["ok"]
        assert second.do("control.release", new)["ok"]
        first.until(lambda: first.control()["holder"] is None)
        assert first.take_control() > new


def test_a_holder_that_has_gone_keeps_no_control(server):
    with server.viewer("second") as second:
        with server.viewer("first") as first:
            first.take_control()
            asked = second.start("control.take")
            second.until(lambda: second.documents.get("control", {}).get("value", {}).get("request") is not None)
        assert second.result(asked)["ok"], "at once, without the 10 s"


def test_a_holder_without_a_sign_of_life_is_away(server):
    with server.viewer("first") as first, server.viewer("second") as second:
        first.take_control()
        second.until(lambda: second.documents.get("control") and second.control()["away"])
        first.send({"type": "beat", "age_ms": 5})
        second.until(lambda: not second.control()["away"])
        second.until(lambda: second.control()["away"])
        first.send({"type": "beat", "age_ms": 5000})  # its worker lives, its main thread does not
        assert second.do("control.take")["ok"]


def test_everybody_may_stop_from_every_state(server):
    with server.viewer("driver") as driver, server.viewer("guest") as guest:
        for state in ("running", "stopped"):
            guest.until(lambda: guest.documents.get("session", {}).get("value", {}).get("state") == state)
            count = len(guest.stops)
            guest.send({"type": "stop"})
            guest.until(lambda: len(guest.stops) > count)
            assert guest.stops[-1] == {"type": "stopped", "confirmed": 5, "of": 5, "ms": 0.5}
        epoch = driver.take_control()
        assert driver.do("run", epoch)["ok"], "only the holder starts again"
        driver.until(lambda: "stopped by guest" in driver.notices)


def test_a_connection_that_is_only_for_stop_gets_nothing_else(server):
    with server.viewer("stop", only="stop") as viewer:
        viewer.send({"type": "subscribe", "signals": EVERYTHING})
        viewer.send({"type": "stop"})
        assert viewer.next()["type"] == "stopped"
        viewer.send({"type": "stop"})  # its answer is behind whatever else was sent
        assert viewer.next()["type"] == "stopped"


def test_stop_may_come_right_behind_hello(server):
    with server.viewer() as first:
        first.until(lambda: "session" in first.documents)
    viewer = Viewer(server.port)
    viewer.send({"type": "hello", "protocol": 1, "token": server.token, "name": "hasty"})
    viewer.send({"type": "stop"})
    assert viewer.next()["type"] == "welcome"
    viewer.until(lambda: viewer.stops)


def test_a_viewer_gets_every_tick(server):
    with server.viewer() as viewer:
        viewer.until(lambda: "telemetry" in viewer.documents)
        layout = viewer.documents["telemetry"]["value"]
        assert [(s["name"], s["offset"], s["count"], s["of"]) for s in layout["signals"]] == [
            ("angle", 0, 5, "joint"), ("contact", 5, 6, "link"), ("count", 11, 1, "robot")]
        assert layout["tick_us"] == 1000
        assert not viewer.rows, "without a subscription nothing is sent"
        epoch = viewer.take_control()
        assert viewer.do("rate", epoch, ticks_per_second=200)["ok"]
        time.sleep(0.6)  # rows are left out by the rate of the last quarter of a second, which was 1000
        viewer.send({"type": "subscribe", "signals": ["count", "angle"], "hash": layout["hash"]})
        viewer.until(lambda: sum(len(m["values"]) for m in viewer.rows) >= 200)
        ticks = []
        for message in viewer.rows:
            assert message["subscription"] == 1 and message["stride"] == 1 and message["run"] == 1
            for i, row in enumerate(message["values"]):
                assert len(row) == 6 and row[0] == 0
                assert set(row[1:]) == {message["tick"] + i}
                ticks.append(message["tick"] + i)
        assert ticks == list(range(ticks[0], ticks[0] + len(ticks)))
        assert not any(message["gap"] for message in viewer.rows)


def test_a_restart_begins_another_run(server):
    with server.viewer() as viewer:
        viewer.until(lambda: "telemetry" in viewer.documents)
        epoch = viewer.take_control()
        viewer.send({"type": "subscribe", "signals": ["count"]})
        viewer.until(lambda: viewer.rows)
        assert viewer.do("restart", epoch)["ok"]
        viewer.until(lambda: viewer.rows[-1]["run"] == 2)
        first = next(message for message in viewer.rows if message["run"] == 2)
        assert first["tick"] == 0 and not first["gap"]


def test_another_subscription_replaces_the_first(server):
    with server.viewer() as viewer:
        viewer.until(lambda: "telemetry" in viewer.documents)
        viewer.send({"type": "subscribe", "signals": ["count"]})
        viewer.send({"type": "subscribe", "signals": []})
        viewer.send({"type": "subscribe", "signals": ["contact"]})
        viewer.until(lambda: viewer.rows and viewer.rows[-1]["subscription"] == 3)
        assert {len(row) for message in viewer.rows for row in message["values"] if message["subscription"] == 3} == {6}


def test_a_subscription_ends_with_the_layout(server):
    with server.viewer() as viewer:
        viewer.until(lambda: "telemetry" in viewer.documents)
        old = viewer.documents["telemetry"]["value"]["hash"]
        epoch = viewer.take_control()
        viewer.send({"type": "subscribe", "signals": ["angle"]})
        viewer.until(lambda: viewer.rows)
        assert viewer.do("joints", epoch, count=8)["ok"]
        viewer.until(lambda: viewer.documents["telemetry"]["value"]["hash"] != old)
        del viewer.rows[:]
        viewer.send({"type": "subscribe", "signals": ["angle"], "hash": old})
        viewer.do("value")
        viewer.do("value")
        assert not viewer.rows, "the offsets of another layout are not used"
        viewer.send({"type": "subscribe", "signals": ["angle"], "hash": viewer.documents["telemetry"]["value"]["hash"]})
        viewer.until(lambda: viewer.rows)
        assert len(viewer.rows[0]["values"][0]) == 8
        viewer.send({"type": "subscribe", "signals": ["angel"]})
        viewer.until(lambda: "subscribe: found 'angel', expected a signal of the document 'telemetry'" in viewer.notices)


def test_a_fast_simulation_is_thinned(server):
    with server.viewer() as viewer:
        viewer.until(lambda: "telemetry" in viewer.documents)
        epoch = viewer.take_control()
        assert viewer.do("rate", epoch, ticks_per_second=8000)["ok"]
        viewer.send({"type": "subscribe", "signals": ["count"]})
        viewer.until(lambda: viewer.rows and viewer.rows[-1]["stride"] > 1)
        thinned = [message for message in viewer.rows if message["stride"] > 1]
        assert all(message["tick"] % message["stride"] == 0 for message in thinned)


def test_notices_are_kept_for_later_viewers(server):
    with server.viewer("first") as first:
        for _ in range(250):
            request(server.port, "POST", "/stop", [f"Authorization: Bearer {server.token}"])
        # The answer may come before the notice.
        first.send({"type": "stop"})
        first.until(lambda: "stopped by first" in first.notices)
        with server.viewer() as viewer:
            viewer.until(lambda: "stopped by first" in viewer.notices)
            viewer.do("value")
            assert len(viewer.notices) == 200


def test_the_server_ends_its_connections_in_order(server):
    viewer = server.viewer()
    server.process.stdin.close()
    closed = viewer.until_closed()
    assert closed.code == 1001, closed
    viewer.sock.close()
    server.process.stdin = None


run_tests(dict(globals()))
