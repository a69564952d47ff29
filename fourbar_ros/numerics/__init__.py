"""Numbers, roots and enclosures; nothing here knows a mechanism."""
