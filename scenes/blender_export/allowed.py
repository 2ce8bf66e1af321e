"""What of Blender's data is understood: the one list of it.

A property, or an input of a node, that is not here is named as not rendered wherever it is not at its default
(differences.py). So what the next version of Blender adds is named by itself.

By the name of the RNA struct: a property, or an input's identifier, and
  READ        any value: the code that reads it names what it cannot express
  INSIDE      a struct, whose own properties are looked at
  a tuple     these values, and no others
  Free        any value: no pixel of what is rendered depends on it, for the reason given
Structs inherit from their bases.
"""


class Free(str):
    """Why a value reaches no pixel."""


READ, INSIDE = object(), object()

UI = Free("is for the editors")
ID = Free("names and keeps data")
DERIVED = Free("follows from what is read")
EDITING = Free("makes what is evaluated, which is read")
OWN = Free("has its own setting in this engine")
METHOD = Free("is how Cycles finds light, not what the light is")
OUTPUT = Free("is for the picture when it is done, whoever rendered it")
EEVEE = Free("is EEVEE's")
MOVES = Free("is of motion blur, which is named")
HAIR = Free("is of hair, which is named")
VOLUMES = Free("is of volumes, which are named")
GLASS = Free("is of glass, which is named")


def of(rule, names):
    return dict.fromkeys(names.split(), rule)


def inputs(rule, names):
    return dict.fromkeys(names.split("|"), rule)


BLACK, WHITE, NEUTRAL = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (0.0,)

PROPERTIES = {
    "ID": of(ID, "name name_full rna_type tag use_fake_user use_extra_user users library library_weak_reference "
                 "override_library original asset_data preview animation_data"),
    "PropertyGroup": of(ID, "name rna_type"),
    # Nodes.
    "Node": {**of(UI, "rna_type name label location width height width_hidden hide select color use_custom_color parent "
                      "show_options show_preview show_texture dimensions"),
             **of(UI, "bl_description bl_height_default bl_height_max bl_height_min bl_icon bl_idname bl_label "
                      "bl_static_type bl_width_default bl_width_max bl_width_min"),
             **of(READ, "type inputs outputs internal_links mute")},
    "ShaderNodeOutputMaterial": of(READ, "is_active_output target"),
    "ShaderNodeOutputWorld": of(READ, "is_active_output target"),
    "ShaderNodeBsdfPrincipled": {"distribution": ("GGX",), "subsurface_method": Free("is of Subsurface, which is named")},
    "ShaderNodeBsdfGlass": {"distribution": ("SHARP", "BECKMANN", "GGX", "MULTI_GGX")},
    "ShaderNodeBsdfGlossy": {"distribution": ("SHARP", "GGX")},
    "ShaderNodeTexImage": {**of(READ, "image extension interpolation texture_mapping"), "projection": ("FLAT",),
                           "projection_blend": Free("is of box projections, which are named"),
                           **of(INSIDE, "image_user color_mapping")},
    "ShaderNodeTexEnvironment": {"image": READ, "projection": ("EQUIRECTANGULAR",), "interpolation": ("Linear",),
                                 **of(INSIDE, "image_user texture_mapping color_mapping")},
    "ShaderNodeTexCoord": {"object": READ, "from_instancer": (False,)},
    "ShaderNodeUVMap": {"uv_map": READ, "from_instancer": (False,)},
    "ShaderNodeMapping": of(READ, "vector_type"),
    "ShaderNodeAttribute": of(READ, "attribute_name attribute_type"),
    "ShaderNodeVertexColor": of(READ, "layer_name"),
    "ShaderNodeMath": {"operation": READ, "use_clamp": (False,)},
    "ShaderNodeMix": {**of(READ, "data_type blend_type"), "clamp_result": (False,),
                      **of(Free("leaves a factor of 1, and no other is read"), "clamp_factor factor_mode")},
    "ShaderNodeMixRGB": {"blend_type": READ, "use_clamp": (False,), "use_alpha": Free("is EEVEE's compositor's")},
    "ShaderNodeSeparateColor": of(READ, "mode"),
    "ShaderNodeNormalMap": of(READ, "space uv_map"),
    "ColorMapping": {"rna_type": ID, "brightness": (1.0,), "contrast": (1.0,), "saturation": (1.0,),
                     "blend_factor": (0.0,), "use_color_ramp": (False,), "color_ramp": Free("is of use_color_ramp"),
                     **of(Free("is of blend_factor"), "blend_color blend_type")},
    "TexMapping": {"rna_type": ID, "vector_type": ("POINT",), "translation": (BLACK,), "rotation": (BLACK,), "scale": (WHITE,),
                   "mapping_x": ("X",), "mapping_y": ("Y",), "mapping_z": ("Z",), "use_min": (False,), "use_max": (False,),
                   "min": Free("is of use_min"), "max": Free("is of use_max"), "mapping": ("FLAT",)},
    "ImageUser": of(Free("is of sequences, movies and layers, which are named"),
                    "rna_type frame_current frame_duration frame_offset frame_start multilayer_layer multilayer_pass "
                    "multilayer_view tile use_auto_refresh use_cyclic"),
    "Image": {**of(READ, "alpha_mode colorspace_settings filepath source"),
              **of(DERIVED, "pixels size channels depth has_data is_dirty is_float packed_file packed_files type filepath_raw "
                            "file_format frame_duration is_multiview is_stereo_3d bindcode tiles"),
              **of(Free("makes texels, which are read"), "generated_color generated_height generated_type generated_width "
                                                         "use_generated_float use_half_precision"),
              **of(UI, "display_aspect resolution render_slots use_view_as_render"),
              **of(Free("is of stereo images, which are named"), "stereo_3d_format views_format"),
              **of(Free("is of movies, which are named"), "use_deinterlace")},
    # What is shown.
    "Object": {
        **of(READ, "type data material_slots matrix_world particle_systems is_shadow_catcher is_holdout instance_type"),
        **of((True,), "visible_camera visible_diffuse visible_glossy visible_transmission visible_volume_scatter "
                      "visible_shadow"),
        "cycles": INSIDE,
        **of(EDITING, "location rotation_euler rotation_quaternion rotation_axis_angle rotation_mode scale delta_location "
                      "delta_rotation_euler delta_rotation_quaternion delta_scale matrix_basis matrix_local "
                      "matrix_parent_inverse dimensions bound_box parent parent_bone parent_type parent_vertices "
                      "constraints modifiers pose pose_library animation_visualization motion_path active_shape_key "
                      "active_shape_key_index use_shape_key_edit_mode show_only_shape_key vertex_groups face_maps collision "
                      "field rigid_body rigid_body_constraint soft_body add_rest_position_attribute track_axis up_axis "
                      "use_camera_lock_parent use_dynamic_topology_sculpting use_mesh_mirror_x use_mesh_mirror_y "
                      "use_mesh_mirror_z grease_pencil_modifiers shader_effects lineart use_grease_pencil_lights mode"),
        **of(EDITING, "hide_render hide_viewport show_instancer_for_render show_instancer_for_viewport instance_collection "
                      "instance_faces_scale use_instance_faces_scale use_instance_vertices_rotation is_instancer"),
        **of(UI, "active_material active_material_index color display display_bounds_type display_type empty_display_size "
                 "empty_display_type empty_image_depth empty_image_offset empty_image_side image_user hide_select "
                 "lock_location lock_rotation lock_rotation_w lock_rotations_4d lock_scale show_all_edges show_axis "
                 "show_bounds show_empty_image_only_axis_aligned show_empty_image_orthographic "
                 "show_empty_image_perspective show_in_front show_name show_texture_space show_transparent show_wire "
                 "use_empty_image_alpha"),
        "lightgroup": READ,
        "pass_index": Free("is of passes of indexes, which are named")},
    "CyclesObjectSettings": {
        **of(MOVES, "motion_steps use_deform_motion use_motion_blur"), **of(METHOD, "ao_distance"),
        **of(GLASS, "is_caustics_caster is_caustics_receiver"),
        "dicing_rate": Free("is of use_adaptive_subdivision"),
        **of(Free("is of culling, which the scene's settings name"), "use_camera_cull use_distance_cull")},
    # Lamps.
    "Light": {**of(READ, "type color use_nodes node_tree energy"), "cycles": INSIDE, "use_shadow": (True,),
              **of(EEVEE, "distance specular_factor diffuse_factor volume_factor transmission_factor use_custom_distance "
                          "cutoff_distance shadow_buffer_size shadow_buffer_clip_start shadow_buffer_bias "
                          "shadow_buffer_samples shadow_color use_contact_shadow contact_shadow_distance "
                          "contact_shadow_bias contact_shadow_thickness shadow_cascade_max_distance shadow_cascade_count "
                          "shadow_cascade_exponent shadow_cascade_fade shadow_soft_size"),
              **of(Free("is EEVEE's and of old files"), "falloff_type falloff_curve linear_attenuation quadratic_attenuation "
                                                        "constant_coefficient linear_coefficient quadratic_coefficient")},
    "PointLight": of(READ, "shadow_soft_size"),
    "SpotLight": {**of(READ, "shadow_soft_size spot_size spot_blend"), "use_square": EEVEE, "show_cone": UI},
    "SunLight": of(READ, "angle"),
    "AreaLight": of(READ, "shape size size_y spread"),
    "CyclesLightSettings": {"is_portal": READ, "cast_shadow": (True,), "use_multiple_importance_sampling": METHOD,
                            "is_caustics_light": GLASS},
    "Mesh": {
        **of(READ, "attributes color_attributes uv_layers loops polygons vertices vertex_normals has_custom_normals "
                   "materials use_auto_smooth auto_smooth_angle normals_domain corner_normals texspace_location "
                   "texspace_size"),
        **of(EDITING, "shape_keys skin_vertices vertex_creases edge_creases has_bevel_weight_edge has_bevel_weight_vertex "
                      "has_crease_edge has_crease_vertex auto_texspace use_auto_texspace is_editmode texture_mesh "
                      "remesh_mode remesh_voxel_adaptivity remesh_voxel_size use_remesh_fix_poles "
                      "use_remesh_preserve_paint_mask use_remesh_preserve_sculpt_face_sets "
                      "use_remesh_preserve_vertex_colors use_remesh_preserve_volume"),
        **of(DERIVED, "edges face_maps loop_triangles polygon_layers_float polygon_layers_int polygon_layers_string "
                      "polygon_normals sculpt_vertex_colors vertex_colors vertex_layers_float vertex_layers_int "
                      "vertex_layers_string"),
        **of(UI, "total_edge_sel total_face_sel total_vert_sel use_mirror_topology use_mirror_vertex_groups use_mirror_x "
                 "use_mirror_y use_mirror_z use_paint_mask use_paint_mask_vertex uv_layer_clone uv_layer_clone_index "
                 "uv_layer_stencil uv_layer_stencil_index vertex_paint_masks"),
        "cycles": INSIDE},
    "CyclesMeshSettings": {},
    "Material": {
        **of(READ, "use_nodes node_tree diffuse_color"), "cycles": INSIDE,
        **of(Free("is heeded by EEVEE, not by Cycles"), "alpha_threshold blend_method shadow_method show_transparent_back "
                                                        "use_backface_culling use_screen_refraction refraction_depth "
                                                        "use_sss_translucency"),
        **of(UI, "metallic roughness specular_color specular_intensity paint_active_slot paint_clone_slot "
                 "preview_render_type texture_paint_images texture_paint_slots use_preview_world"),
        **of(Free("is of grease pencil and freestyle, which are named"), "grease_pencil is_grease_pencil line_color "
                                                                         "line_priority lineart"),
        "pass_index": Free("is of passes of indexes, which are named")},
    "CyclesMaterialSettings": {
        "displacement_method": Free("is of Displacement, which is named"), "sample_as_light": METHOD,
        "use_transparent_shadow": READ,
        **of(VOLUMES, "homogeneous_volume volume_interpolation volume_sampling volume_step_rate")},
    # World and camera.
    "World": {
        **of(READ, "use_nodes node_tree color"), **of(INSIDE, "cycles cycles_visibility"),
        **of(METHOD, "light_settings"), "mist_settings": Free("is of the pass Mist, which is named"),
        "lightgroup": READ},
    "CyclesWorldSettings": {
        **of(METHOD, "sample_map_resolution sampling_method"), **of(GLASS, "is_caustics_light"),
        **of(VOLUMES, "homogeneous_volume volume_interpolation volume_sampling volume_step_size")},
    "CyclesVisibilitySettings": {**of((True,), "camera diffuse glossy"),
                                 "transmission": GLASS, "scatter": VOLUMES,
                                 "shadow": Free("is of lamps and objects; a world has no shadow rays of its own")},
    "Camera": {
        **of(READ, "type angle angle_x angle_y lens lens_unit ortho_scale sensor_fit sensor_height sensor_width shift_x "
                   "shift_y clip_start clip_end"),
        "dof": INSIDE,
        **of(UI, "background_images show_background_images display_size passepartout_alpha show_composition_center "
                 "show_composition_center_diagonal show_composition_golden show_composition_golden_tria_a "
                 "show_composition_golden_tria_b show_composition_harmony_tri_a show_composition_harmony_tri_b "
                 "show_composition_thirds show_limits show_mist show_name show_passepartout show_safe_areas "
                 "show_safe_center show_sensor"),
        "stereo": Free("is of stereoscopy, which is named"),
        "cycles": Free("is of panoramas, which are refused")},
    "CameraDOFSettings": {**of(READ, "use_dof focus_distance focus_object aperture_fstop aperture_blades aperture_rotation"),
                          "aperture_ratio": (1.0,), "rna_type": ID},
    # What a render is asked for.
    "ViewLayer": {
        **of(READ, "use_sky material_override objects layer_collection name rna_type"),
        "use_solid": (True,), "cycles": INSIDE,
        **of(DERIVED, "depsgraph active_layer_collection active_aov active_aov_index active_lightgroup "
                      "active_lightgroup_index use use_pass_combined pass_cryptomatte_depth use_pass_cryptomatte_accurate "
                      "pass_alpha_threshold"),
        **of(OWN, "samples"), **of(METHOD, "use_ao"), **of(MOVES, "use_motion_blur"), **of(HAIR, "use_strand"),
        **of(VOLUMES, "use_volumes"), "eevee": EEVEE,
        **of(Free("is of freestyle, which is named"), "freestyle_settings use_freestyle"),
        **of(READ, "use_pass_mist use_pass_vector use_pass_uv use_pass_object_index use_pass_material_index "
                   "use_pass_transmission_direct use_pass_transmission_indirect use_pass_transmission_color "
                   "use_pass_subsurface_direct use_pass_subsurface_indirect use_pass_subsurface_color use_pass_shadow "
                   "use_pass_ambient_occlusion use_pass_cryptomatte_object use_pass_cryptomatte_material "
                   "use_pass_cryptomatte_asset"),
        "lightgroups": READ,
        **of(READ, "use_pass_z use_pass_normal use_pass_position use_pass_diffuse_direct use_pass_diffuse_indirect "
                   "use_pass_diffuse_color use_pass_glossy_direct use_pass_glossy_indirect use_pass_glossy_color "
                   "use_pass_emit use_pass_environment")},
    "CyclesRenderLayerSettings": {**of(OWN, "use_denoising"), **of(READ, "denoising_store_passes")},
    "RenderSettings": {
        **of(READ, "resolution_x resolution_y resolution_percentage pixel_aspect_x pixel_aspect_y use_border border_min_x "
                   "border_max_x border_min_y border_max_y use_crop_to_border film_transparent fps fps_base engine"),
        "rna_type": ID,
        **of(EDITING, "use_simplify simplify_subdivision simplify_subdivision_render simplify_child_particles "
                      "simplify_child_particles_render simplify_volumes simplify_gpencil simplify_gpencil_antialiasing "
                      "simplify_gpencil_modifier simplify_gpencil_onplay simplify_gpencil_shader_fx simplify_gpencil_tint "
                      "simplify_gpencil_view_fill frame_map_new frame_map_old use_single_layer"),
        **of(MOVES, "motion_blur_shutter motion_blur_shutter_curve"), **of(HAIR, "hair_subdiv hair_type"),
        **of(Free("is of stereoscopy, which is named"), "views views_format stereo_views use_spherical_stereo"),
        **of(Free("is of freestyle, which is named"), "line_thickness line_thickness_mode"),
        **of(EEVEE, "filter_size use_high_quality_normals"),
        **of(METHOD, "threads threads_mode use_persistent_data use_lock_interface use_render_cache preview_pixel_size "
                     "has_multiple_engines"),
        **of(Free("is of baking to images"), "bake bake_bias bake_margin bake_margin_type bake_samples bake_type "
                                             "bake_user_scale use_bake_clear use_bake_lores_mesh use_bake_multires "
                                             "use_bake_selected_to_active use_bake_user_scale"),
        **of(OUTPUT, "dither_intensity ffmpeg file_extension filepath image_settings is_movie_format metadata_input "
                     "sequencer_gl_preview use_compositing use_sequencer use_sequencer_override_scene_strip "
                     "use_file_extension use_overwrite use_placeholder stamp_background stamp_font_size stamp_foreground "
                     "stamp_note_text use_stamp use_stamp_camera use_stamp_date use_stamp_filename use_stamp_frame "
                     "use_stamp_frame_range use_stamp_hostname use_stamp_labels use_stamp_lens use_stamp_marker "
                     "use_stamp_memory use_stamp_note use_stamp_render_time use_stamp_scene use_stamp_sequencer_strip "
                     "use_stamp_time")},
    "Scene": {
        **of(READ, "camera world frame_current frame_current_final frame_start frame_end frame_step frame_float "
                   "frame_subframe timeline_markers view_layers objects collection"),
        **of(INSIDE, "render cycles"), "cycles_curves": HAIR, "eevee": EEVEE,
        **of(EDITING, "gravity use_gravity rigidbody_world is_nla_tweakmode background_set"),
        **of(OUTPUT, "view_settings display_settings sequence_editor sequencer_colorspace_settings use_nodes node_tree "
                     "audio_distance_model audio_doppler_factor audio_doppler_speed audio_volume use_audio "
                     "use_audio_scrub use_stamp_note"),
        **of(UI, "active_clip cursor display frame_preview_end frame_preview_start use_preview_range grease_pencil "
                 "grease_pencil_settings keying_sets keying_sets_all lock_frame_selection_to_range safe_areas "
                 "show_keys_from_selected_only show_subframe sync_mode tool_settings transform_orientation_slots "
                 "unit_settings")},
    "CyclesRenderSettings": {
        **of(OWN, "samples sample_offset seed use_animated_seed use_adaptive_sampling adaptive_min_samples "
                  "adaptive_threshold time_limit use_denoising denoiser denoising_input_passes denoising_prefilter "
                  "max_bounces diffuse_bounces glossy_bounces sample_clamp_direct sample_clamp_indirect pixel_filter_type "
                  "filter_width use_layer_samples"),
        "transparent_max_bounces": READ,
        **of(Free("is of Fast GI, which is named"), "ao_bounces ao_bounces_render fast_gi_method"),
        **of(METHOD, "auto_scrambling_distance scrambling_distance blur_glossy device "
                     "direct_light_sampling_type light_sampling_threshold min_light_bounces "
                     "min_transparent_bounces sampling_pattern tile_size use_auto_tile "
                     "shading_system guiding_distribution_type guiding_training_samples surface_guiding_probability "
                     "use_guiding use_guiding_direct_light use_guiding_mis_weights use_deterministic_guiding "
                     "use_surface_guiding use_volume_guiding volume_guiding_probability debug_bvh_layout "
                     "debug_bvh_time_steps debug_bvh_type debug_use_compact_bvh debug_use_cpu_avx debug_use_cpu_avx2 "
                     "debug_use_cpu_sse2 debug_use_cpu_sse3 debug_use_cpu_sse41 debug_use_cuda_adaptive_compile "
                     "debug_use_hair_bvh debug_use_optix_debug debug_use_spatial_splits"),
        **of(UI, "preview_adaptive_min_samples preview_adaptive_threshold preview_denoiser preview_denoising_input_passes "
                 "preview_denoising_prefilter preview_denoising_start_sample preview_dicing_rate preview_pause "
                 "preview_samples preview_scrambling_distance use_preview_adaptive_sampling use_preview_denoising "
                 "texture_limit"),
        **of(GLASS, "caustics_refractive film_transparent_glass film_transparent_roughness transmission_bounces"),
        **of(VOLUMES, "volume_bounces volume_max_steps volume_preview_step_rate volume_step_rate"),
        **of(MOVES, "motion_blur_position rolling_shutter_duration rolling_shutter_type"),
        **of(Free("is of culling, which is named"), "camera_cull_margin distance_cull_margin"),
        **of(Free("is of adaptive subdivision, which is named"), "dicing_camera dicing_rate max_subdivisions "
                                                                 "offscreen_dicing_scale feature_set"),
        "bake_type": Free("is of baking to images")},
}

# Inputs by their identifiers. Of nodes that are not here, the whole node is named.
INPUTS = {
    "ShaderNodeOutputMaterial": {"Surface": READ, "Displacement": (BLACK,), "Thickness": EEVEE},
    "ShaderNodeOutputWorld": {"Surface": READ},
    "ShaderNodeBackground": {**inputs(READ, "Color|Strength"), "Weight": DERIVED},
    "ShaderNodeEmission": {**inputs(READ, "Color|Strength"), "Weight": DERIVED},
    "ShaderNodeBsdfDiffuse": {**inputs(READ, "Color|Normal"), "Roughness": NEUTRAL, "Weight": DERIVED},
    "ShaderNodeBsdfPrincipled": {
        **inputs(READ, "Base Color|Metallic|Specular|Specular IOR Level|Specular Tint|Roughness|IOR|Emission|Emission Color|"
                       "Emission Strength|Alpha|Normal|Transmission|Transmission Weight"),
        **inputs(NEUTRAL, "Subsurface|Subsurface Weight|Anisotropic|Sheen|Sheen Weight|Clearcoat|Coat Weight|"
                          "Transmission Roughness"),
        **inputs(Free("is of Subsurface, which is named"), "Subsurface Radius|Subsurface Color|Subsurface IOR|"
                                                           "Subsurface Anisotropy|Subsurface Scale"),
        **inputs(Free("is of Anisotropic, which is named"), "Anisotropic Rotation|Tangent"),
        **inputs(Free("is of Sheen, which is named"), "Sheen Tint|Sheen Roughness"),
        **inputs(Free("is of Clearcoat, which is named"), "Clearcoat Roughness|Clearcoat Normal|Coat Roughness|Coat IOR|"
                                                          "Coat Tint|Coat Normal"),
        "Weight": DERIVED},
    "ShaderNodeBsdfTransparent": {"Color": READ, "Weight": DERIVED},
    "ShaderNodeBsdfGlass": {**inputs(READ, "Color|Roughness|IOR"), "Weight": DERIVED},
    "ShaderNodeBsdfGlossy": {**inputs(READ, "Color|Roughness"), "Weight": DERIVED},
    "ShaderNodeAddShader": inputs(READ, "Shader|Shader_001"),
    "ShaderNodeMixShader": inputs(READ, "Fac|Shader|Shader_001"),
    "ShaderNodeFresnel": {"IOR": READ},
    "ShaderNodeLightPath": {},
    "ShaderNodeTexImage": inputs(READ, "Vector"),
    "ShaderNodeTexEnvironment": inputs(READ, "Vector"),
    "ShaderNodeTexCoord": {},
    "ShaderNodeUVMap": {},
    "ShaderNodeMapping": inputs(READ, "Vector|Location|Rotation|Scale"),
    "ShaderNodeAttribute": {},
    "ShaderNodeVertexColor": {},
    "ShaderNodeRGB": {},
    "ShaderNodeValue": {},
    "ShaderNodeBlackbody": inputs(READ, "Temperature"),
    "ShaderNodeMath": inputs(READ, "Value|Value_001|Value_002"),
    "ShaderNodeMix": inputs(READ, "Factor_Float|Factor_Vector|A_Float|B_Float|A_Vector|B_Vector|A_Color|B_Color"),
    "ShaderNodeMixRGB": inputs(READ, "Fac|Color1|Color2"),
    "ShaderNodeSeparateColor": inputs(READ, "Color"),
    "ShaderNodeSeparateRGB": inputs(READ, "Image"),
    "ShaderNodeNormalMap": inputs(READ, "Strength|Color"),
}

# In place of a property's name and value.
WORDS = {
    ("Object", "visible_camera"): "hidden from the camera",
    ("Object", "visible_diffuse"): "hidden from diffuse rays",
    ("Object", "visible_glossy"): "hidden from glossy rays",
    ("Object", "visible_transmission"): "hidden from rays through glass",
    ("Object", "visible_volume_scatter"): "hidden from rays of volumes",
    ("Object", "visible_shadow"): "casts no shadow",
    ("CyclesVisibilitySettings", "camera"): "hidden from the camera",
    ("CyclesVisibilitySettings", "diffuse"): "hidden from diffuse rays",
    ("CyclesVisibilitySettings", "glossy"): "hidden from glossy rays",
    ("RenderSettings", "use_motion_blur"): "motion blur: all is where it is at the frame",
    ("RenderSettings", "use_freestyle"): "freestyle: its lines",
    ("RenderSettings", "use_multiview"): "stereoscopy: both eyes see what the camera sees",
}
