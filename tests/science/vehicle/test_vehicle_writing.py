"""Writing a car's XML: only what is meant changes, and what was written reads back."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from app.science.errors import VehicleConfigError
from app.science.vehicle.elements import FIELD_OF, FIELDS
from app.science.vehicle.fields import FormError, apply_form, form_values
from app.science.vehicle.model import Injection, Mounting, Vehicle
from app.science.vehicle.xml import config_fingerprint, examine_vehicle, new_car_xml, read_vehicle, write_vehicle

SAMPLE = Path(__file__).with_name("smart_roadster.xml").read_bytes()
STRANGE = b"""<?xml version="1.0" encoding="ISO-8859-1"?>\r
<?note keep me?>\r
<!-- before -->\r
<ponthy_config version="7">\r
  <car>\r
    <make make="Citro\xebn"/>\r
  </car>\r
  <hovercraft eels="full"><!-- inside --></hovercraft>\r
  <mass wet="1200 kg" dry="1100"/>\r
  <file Name="one.dat"/>\r
</ponthy_config>\r
<!-- after -->\r
"""


def changed_lines(before: bytes, after: bytes) -> list[bytes]:
    kept = before.splitlines()
    return [line for line in after.splitlines() if line not in kept]


def test_a_change_touches_its_line_only() -> None:
    tidy = SAMPLE.replace(b" />", b"/>").replace(b" ?>", b"?>")
    after = write_vehicle(tidy, {"mass@wet": 900.0})
    assert changed_lines(tidy, after) == [b'  <mass wet="900"/>']
    assert len(after.splitlines()) == len(tidy.splitlines())


def test_what_means_the_same_is_left_as_it_is() -> None:
    same = {"engine/displacement@displacement": 0.698, "drag/aero@Cd": "0,390", "engine/power@power": "60kW @5250rpm"}
    assert write_vehicle(SAMPLE, same) == SAMPLE
    assert write_vehicle(SAMPLE, read_vehicle(SAMPLE)) != b""
    assert read_vehicle(write_vehicle(SAMPLE, read_vehicle(SAMPLE))) == read_vehicle(SAMPLE)


def test_units_comments_order_encoding_and_the_unknown_are_kept() -> None:
    after = write_vehicle(STRANGE, {"mass@wet": 1250.0, "fuel@type": "diesel", "car/owner@owner": "Žofie"})
    assert changed_lines(STRANGE, after) == [
        b'    <owner owner="&#381;ofie"/>',
        b'  <mass wet="1250 kg" dry="1100"/>',
        b'  <fuel type="diesel"/>',
    ]
    assert after.index(b"<fuel") < after.index(b"<file")
    assert b"\n" not in after.replace(b"\r\n", b"")
    vehicle = read_vehicle(after)
    assert (vehicle.make, vehicle.owner, vehicle.mass_wet_kg) == ("Citroën", "Žofie", 1250.0)


def test_utf16_stays_utf16() -> None:
    wide = SAMPLE.decode().replace('encoding="UTF-8"', 'encoding="UTF-16"').encode("utf-16")
    after = write_vehicle(wide, {"mass@wet": 900.0})
    assert after.decode("utf-16").rstrip().endswith("</ponthy_config>")
    assert read_vehicle(after).mass_wet_kg == 900.0


def test_a_value_is_emptied_and_filled_again() -> None:
    without = write_vehicle(SAMPLE, {"transmission/sixth@gear": None, "inj/calibration@lag": ""})
    vehicle = read_vehicle(without)
    assert vehicle.gear_ratios == (13.25, 9.604, 7.37, 5.796, 4.208)
    assert vehicle.injection.lag_s == Injection().lag_s
    again = write_vehicle(without, {"transmission/sixth@gear": 3.23, "inj/calibration@lag": -0.0004})
    assert read_vehicle(again) == read_vehicle(SAMPLE)
    assert config_fingerprint(again) == config_fingerprint(SAMPLE)


def test_an_impossible_result_is_not_written() -> None:
    with pytest.raises(VehicleConfigError, match="ratios must fall"):
        write_vehicle(SAMPLE, {"transmission/first@gear": 5.0})
    with pytest.raises(VehicleConfigError, match="no value 'mass@dry'"):
        write_vehicle(SAMPLE, {"mass@dry": 800.0})


def test_a_new_car_has_every_element_and_no_value() -> None:
    fresh = new_car_xml()
    reading = examine_vehicle(fresh)
    assert reading.vehicle == Vehicle()
    assert reading.warnings == reading.unknown == ()
    assert b"<mass wet=" in fresh
    named = new_car_xml({"car/make@make": "Smart", "mass@wet": 844.0})
    assert (read_vehicle(named).title, read_vehicle(named).mass_wet_kg) == ("Smart", 844.0)


def test_the_form_shows_what_the_file_says() -> None:
    values = form_values(SAMPLE)
    assert list(values) == [field.path for field in FIELDS]
    assert values["engine/displacement@displacement"] == 0.698
    assert values["inj/timing@pattern"] == "sequential"
    assert values["transmission/reverse@gear"] is None
    assert values["engine/power@power"] == "60kW @5250rpm"
    broken = SAMPLE.replace(b'wet="844"', b'wet="heavy"')
    assert form_values(broken)["mass@wet"] == "heavy"
    assert read_vehicle(apply_form(broken, {"mass@wet": "844 kg"})).mass_wet_kg == 844.0


def test_an_untouched_form_changes_nothing() -> None:
    assert apply_form(SAMPLE, form_values(SAMPLE)) == SAMPLE


def test_the_form_answers_every_bad_value() -> None:
    with pytest.raises(FormError) as caught:
        apply_form(SAMPLE, {"mass@wet": -1.0, "drag/aero@Cd": "much", "car/make@make": "Fine", "no@such": 1.0})
    assert set(caught.value.fields) == {"mass@wet", "drag/aero@Cd", "no@such"}
    assert "between 50 and 60000 kg" in caught.value.fields["mass@wet"]
    with pytest.raises(FormError) as together:
        apply_form(SAMPLE, {"transmission/second@gear": 20.0})
    assert "ratios must fall" in together.value.fields["transmission/second@gear"]


def test_every_field_explains_itself() -> None:
    assert len(FIELD_OF) == len(FIELDS)
    for field in FIELDS:
        assert field.label
        assert field.group
        assert field.help.endswith(".")
        if field.kind == "number" and field.usual:
            assert field.minimum is not None
            assert field.maximum is not None
            assert field.minimum <= field.usual[0] < field.usual[1] <= field.maximum
        if field.default is not None and field.kind == "number":
            assert field.read(str(field.default)) == field.default
            assert field.remark(field.default) == ""


def numbers(path: str) -> st.SearchStrategy[float]:
    field = FIELD_OF[path]
    return st.floats(field.minimum, field.maximum)


words = st.text(st.characters(codec="utf-8", categories=("L", "N", "P", "S")), max_size=20)
vehicles = st.builds(
    Vehicle,
    owner=words,
    make=words,
    model=words,
    engine_type=st.sampled_from(["Inline 4", "V6", "1.4 TDI 4 cyl"]),
    displacement_l=st.none() | numbers("engine/displacement@displacement"),
    idle_rpm=numbers("engine/idle@rpm"),
    engine_inertia_kgm2=numbers("engine/inertia@lumped"),
    wheel_radius_m=numbers("wheels/radius@m"),
    mounting=st.builds(
        Mounting,
        numbers("accelerometer/calibration/roll@phi"),
        numbers("accelerometer/calibration/pitch@theta"),
        numbers("accelerometer/calibration/yaw@psi"),
        numbers("accelerometer/calibration/scale@scale"),
    ),
    gear_ratios=st.lists(st.floats(0.1, 100.0), max_size=10, unique=True).map(lambda r: tuple(sorted(r, reverse=True))),
    cd=numbers("drag/aero@Cd"),
    crr=numbers("drag/rolling@Crr"),
    mass_wet_kg=numbers("mass@wet"),
    injection=st.builds(
        Injection,
        numbers("inj/calibration@fuelPerSecond"),
        numbers("inj/calibration@lag"),
        st.just("grouped"),
        st.integers(1, 16),
    ),
    vss_m_per_tick=numbers("vss/calibration@metersPerTick"),
    speed_scale=numbers("vss/calibration@speedScale"),
    fuel_density_kg_per_l=numbers("fuel@density"),
)


@given(vehicles, st.sampled_from([None, SAMPLE, b"<ponthy_config/>"]))
def test_a_written_car_reads_back_the_same(vehicle: Vehicle, into: bytes | None) -> None:
    vehicle = replace(
        vehicle,
        cylinders={"V6": 6}.get(vehicle.engine_type, 4),
        owner=vehicle.owner.strip(),
        make=vehicle.make.strip(),
        model=vehicle.model.strip(),
    )
    back = read_vehicle(write_vehicle(into, vehicle))
    assert replace(back, files=(), tyre=vehicle.tyre, compression_ratio=None) == replace(vehicle, files=())


@settings(suppress_health_check=[HealthCheck.too_slow])
@given(st.data())
def test_a_damaged_file_is_read_or_refused_and_never_worse(data: st.DataObject) -> None:
    damaged = bytearray(data.draw(st.sampled_from([SAMPLE, STRANGE])))
    for _ in range(data.draw(st.integers(1, 6))):
        at = data.draw(st.integers(0, len(damaged) - 1))
        kind = data.draw(st.sampled_from(["flip", "insert", "cut", "copy"]))
        if kind == "flip":
            damaged[at] = data.draw(st.integers(0, 255))
        elif kind == "insert":
            damaged[at:at] = data.draw(
                st.sampled_from([b"&x;", b"<", b'"', b"]]>", b"\xff", b"<!--", b"<!DOCTYPE a>", b" x=''", b"1e99"])
                | st.binary(max_size=5)
            )
        elif kind == "cut":
            del damaged[at : at + data.draw(st.integers(1, 200))]
        else:
            damaged[at:at] = damaged[: data.draw(st.integers(0, 300))]
        if not damaged:
            break
    xml = bytes(damaged)
    try:
        read_vehicle(xml)
        form_values(xml)
        config_fingerprint(xml)
        after = write_vehicle(xml, {"mass@wet": 901.5, "fuel@energy": 30.0})
    except VehicleConfigError:
        return
    assert read_vehicle(after).mass_wet_kg == 901.5
