"""Many designs of one suspension in one call: what varies, what becomes of each, and how they are solved."""
