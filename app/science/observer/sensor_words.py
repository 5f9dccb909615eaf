"""What people call the sensors."""

WORDS = {
    "vss": "Wheels",
    "speed": "Speed, reported",
    "acc_i": "Accelerometer, forward",
    "acc_j": "Accelerometer, sideways",
    "acc_k": "Accelerometer, vertical",
    "acc_x": "Accelerometer, own x axis",
    "acc_y": "Accelerometer, own y axis",
    "acc_z": "Accelerometer, own z axis",
    "heading": "Course or compass",
    "pitch": "Slope, reported",
    "curvature_h": "Curvature of the road",
    "yaw_rate": "Gyroscope, turning",
    "gps_north": "Position, north",
    "gps_east": "Position, east",
    "gps_altitude": "Position, height",
    "dem_altitude": "Road height",
    "engine_torque": "Engine torque, reported",
    "standstill": "Standstill",
    "fuel_energy": "Fuel, pulse by pulse",
    "fuel_power": "Fuel flow",
    "engine_angle": "Engine turns",
    "engine_speed": "Engine speed",
}
"""Words for every name of `Innovations.sensors`."""


def sensor_words(name: str) -> str:
    """Return what people call a sensor."""
    return WORDS.get(name, name.replace("_", " "))
