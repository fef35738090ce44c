"""Virtual testers: what a Kawabata laboratory and a drapemeter would print of a fabric, measured on the lattice, laws and solver of garments."""
