"""A scene file, read and checked."""
