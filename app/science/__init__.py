"""The pure core: bytes and arrays in, frozen dataclasses out."""
