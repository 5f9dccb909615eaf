"""The XML a new car begins with."""

TEMPLATE = b"""<?xml version="1.0" encoding="UTF-8"?>
<ponthy_config>
  <!-- Every value may stay empty: a default stands in. Units may be written: 698cc, 1,25, 148\xc2\xb0, -0.4 ms. -->
  <car>
    <owner owner=""/>
    <make make=""/>
    <model model=""/>
    <year year=""/>
    <color color=""/>
  </car>
  <engine>
    <!-- The number of cylinders is read from the type: Inline 3, V6, 4 cyl. -->
    <type type=""/>
    <displacement displacement=""/>
    <!-- 60kW @5250rpm and 110Nm @4500rpm -->
    <power power=""/>
    <torque torque=""/>
    <compression comp=""/>
    <idle rpm=""/>
    <!-- Everything that turns with the engine, without wheels and tyres, kg m2 -->
    <inertia lumped=""/>
  </engine>
  <wheels>
    <!-- The code on the tyre's side, 205/45 R16; or the measured rolling radius in m -->
    <tire summer=""/>
    <radius m=""/>
    <!-- Of one wheel with its tyre, kg m2 -->
    <inertia lumped=""/>
  </wheels>
  <accelerometer type="">
    <!-- Rz(psi) Ry(theta) Rx(phi), times scale, turns the sensor's axes into forward, right, down; radians -->
    <calibration>
      <roll phi=""/>
      <pitch theta=""/>
      <yaw psi=""/>
      <scale scale=""/>
    </calibration>
  </accelerometer>
  <transmission type="">
    <!-- Turns of the engine per turn of the wheel, final drive included -->
    <reverse gear=""/>
    <first gear=""/>
    <second gear=""/>
    <third gear=""/>
    <fourth gear=""/>
    <fifth gear=""/>
    <sixth gear=""/>
  </transmission>
  <drag>
    <aero Cd=""/>
    <rolling Crr=""/>
  </drag>
  <!-- Frontal area, m2 -->
  <area frontal=""/>
  <!-- The car alone with all its fluids, kg -->
  <mass wet=""/>
  <inj>
    <!-- Litres per second of all injectors together; s added to the length of the voltage pulse -->
    <calibration fuelPerSecond=""/>
    <calibration lag=""/>
    <!-- sequential, grouped (with groups="2") or simultaneous -->
    <timing pattern=""/>
    <!-- port, direct, or dual where a second group of injectors comes in with load -->
    <system type=""/>
  </inj>
  <!-- petrol, diesel, e10, e85 or lpg; energy in MJ/l and density in kg/l where the fuel is another -->
  <fuel type="" energy="" density=""/>
  <vss>
    <!-- m the car rolls from tick to tick -->
    <calibration metersPerTick=""/>
    <!-- Of logs that tell a speed instead of ticks: true speed over the told one -->
    <calibration speedScale=""/>
  </vss>
  <!-- Of electric and hybrid cars; all values are of one cell: 2.3 Ah, 8 mOhm, 70 % -->
  <battery name="">
    <cells series="" parallel=""/>
    <!-- When new, and as it is thought to be now -->
    <capacity rated="" initial=""/>
    <resistance ohm=""/>
    <relaxation capacitance="" resistance=""/>
    <soc initial=""/>
    <!-- Open-circuit voltage in rows, soc="0 0.5 1" volts="3.0 3.3 3.5"; or a polynomial, coefficients="3.0 0.5" -->
    <ocv soc="" volts=""/>
    <!-- ekf_bias, ekf, ukf or gpc -->
    <estimator type=""/>
    <noise voltage="" current=""/>
    <!-- Share of the rated capacity at which the battery counts as spent -->
    <life end=""/>
  </battery>
</ponthy_config>
"""
