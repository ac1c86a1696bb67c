"""Every assembly of a knuckle on its legs, complex ones too: counted, certified, and told apart."""
