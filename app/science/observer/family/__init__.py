"""The filters of Sebesta 2010, App. A, over one motion model: researchers choose and compare, nobody else has to."""
