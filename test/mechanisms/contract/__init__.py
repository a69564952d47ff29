"""
The contract of a mechanism, for every kind with every input in every mode.

A new kind is tested by being one: its joints and names go into :class:`support.cartesian.Kind`,
all else comes from the registry of kinds. Machines of dyads
share the tests that ask nothing but a mechanism (``every_mechanism``). The others draw lengths and
one mode, and give them to a kind; a machine is drawn with its structure, has a mode for each dyad
and no registry of lengths, so its accuracy, ranges, modes and scenes are tested in
``test/mechanisms/machine`` and ``test/scene``.
"""
