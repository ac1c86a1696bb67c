"""Two solutions of one scene, held to what each claims."""
